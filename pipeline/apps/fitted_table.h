/// Markdown on a terminal that it is too wide for.
#pragma once

#include <string>

namespace npdr::pipeline {

/// The text with its prose wrapped, and each table's columns as far as they fit into a terminal's
/// `columns`; below a table that has more of them, how many, and that `file` holds them. Indented
/// lines, which people copy, are left whole.
std::string fitted_tables(const std::string& markdown, int columns, const std::string& file);

}  // namespace npdr::pipeline
