/// A table as Markdown, CSV, LaTeX and HTML. The best numbers of a row (Table::best_of) are bold
/// but in CSV. All throw what Table::check() throws.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

/// A format in which tables are written to files.
struct TableFormat {
  const char* extension;
  std::string (*to_text)(const Table& table);
};
inline constexpr TableFormat kTableFormats[] = {
    {".md", to_markdown}, {".csv", to_csv}, {".tex", to_latex}};

/// The files of a table, one a format, in `directory`.
std::vector<std::filesystem::path> table_files(std::string_view name,
                                               const std::filesystem::path& directory);

/// Writes all files of a table.
void write_table(const Table& table, const std::filesystem::path& directory);

/// Removes those that there are. Throws Error.
void remove_table(std::string_view name, const std::filesystem::path& directory);

}  // namespace npdr::analysis
