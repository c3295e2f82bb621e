/// Text in the columns of a terminal. Characters from U+3000 on count two.
#pragma once

#include <optional>
#include <string>

namespace npdr::pipeline {

/// Width and height of a terminal, in characters.
struct TerminalSize {
  int columns = 80;
  int rows = 24;
};

/// That of the terminal that the descriptor is, as it is now; none where it is a file or a pipe.
std::optional<TerminalSize> terminal_size(int descriptor);
/// Columns of stdout.
std::optional<int> terminal_columns();

/// `text` in at most that many columns, its end replaced by "..." where it is longer.
std::string fitted(const std::string& text, int columns);

/// The words of `text` in lines of at most that many columns, or of a single longer word; each line
/// begins with the blanks that the first one begins with.
std::string wrapped(const std::string& text, int columns);

/// Markdown with its prose wrapped, and each table's columns as far as they fit into `columns`;
/// below a table that has more of them, how many, and that `file` holds them. Indented lines, which
/// people copy, are left whole.
std::string fitted_tables(const std::string& markdown, int columns, const std::string& file);

}  // namespace npdr::pipeline
