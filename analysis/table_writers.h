/// A table as Markdown, CSV, LaTeX and HTML. All throw what Table::check() throws.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "analysis/table.h"

namespace npdr::analysis {

/// GitHub-flavored Markdown with columns that line up in a terminal too: caption, table, footnotes
/// marked (a), (b), ..., and the command.
std::string to_markdown(const Table& table);

/// For machines: a header line, then a line per row, quoted as RFC 4180 says, lines ended by LF. A
/// column with means becomes three: "<title> mean", "<title> std", "<title> n" (text and plain
/// numbers go to the first). Numbers have all their digits; what is unknown is empty. Caption and
/// footnotes have no place here.
std::string to_csv(const Table& table);

/// A table environment for the booktabs package; the command is a comment at its head.
std::string to_latex(const Table& table);

/// A figure element: the table, its caption and footnotes.
std::string to_html(const Table& table);

/// Writes <name>.md, <name>.csv and <name>.tex into `directory`.
void write_table(const Table& table, const std::filesystem::path& directory);

/// Removes these files of a table, where there are any. Throws Error.
void remove_table(std::string_view name, const std::filesystem::path& directory);

}  // namespace npdr::analysis
