/// One page that holds a study's results: report.html, which needs nothing beside it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/table.h"

namespace npdr::analysis {

/// Width of a figure that fits into the page on a telephone, [px].
inline constexpr double kNarrowWidth = 340.0;

struct ReportFigure {
  std::filesystem::path svg;
  std::string caption;
  std::optional<std::filesystem::path> narrow = {};  ///< in its place where the page is narrow
};

struct ReportSection {
  std::string title;
  std::string prose = {};  ///< plain text; blank lines separate paragraphs
  std::vector<Table> tables = {};
  std::vector<ReportFigure> figures = {};
  std::string remarks = {};    ///< below the tables, like the prose above them
  bool figures_first = false;  ///< before the tables
  bool is_folded = false;      ///< shown when asked for
  std::string code = {};       ///< lines to copy, at the end
};

/// Whether something can be trusted, under the title.
struct ReportVerdict {
  bool holds = false;
  std::string words;                      ///< lines
  std::vector<std::string> reasons = {};  ///< what was found and what to do, lines each
};

struct Report {
  std::string title;
  std::string prose;  ///< under the title
  std::vector<ReportVerdict> verdicts = {};
  std::vector<ReportSection> sections = {};
  std::vector<std::string> commands = {};  ///< that repeat the study, in order
  /// Origin of the results: ("git revision", "1a2b3c"), ("seed", "1"), ...
  std::vector<std::pair<std::string, std::string>> provenance = {};
};

/// The page: style, SVG figures and one script of its own inline, light or dark as the reader's
/// system asks. Every text is escaped, and the page's policy lets no other script run. Throws Error
/// for a figure that can't be read, InputError for one that is no SVG, and what Table::check()
/// throws.
std::string to_html(const Report& report);

/// Writes the page to `path`.
void write_report(const Report& report, const std::filesystem::path& path);

}  // namespace npdr::analysis
