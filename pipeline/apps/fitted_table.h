/// Markdown tables on a terminal that they are too wide for.
#pragma once

#include <cstddef>
#include <string>

namespace npdr::pipeline {

/// The text with each table's columns as far as they fit into a terminal's `columns`; below a table
/// that has more of them, how many, and that `file` holds them.
std::string fitted_tables(const std::string& markdown, std::size_t columns,
                          const std::string& file);

}  // namespace npdr::pipeline
