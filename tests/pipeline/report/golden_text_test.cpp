// What functions make of texts: tests/golden/text.txt.
#include <fmt/format.h>

#include <functional>
#include <map>
#include <sstream>

#include "analysis/escape.h"
#include "analysis/figure_layout.h"
#include "analysis/latex_symbols.h"
#include "analysis/number_text.h"
#include "analysis/table.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/study.h"
#include "pipeline/process/fitted_text.h"
#include "pipeline/process/progress.h"
#include "pipeline/run/run_progress.h"
#include "pipeline/store/number_table.h"
#include "tests/golden_file.h"

namespace npdr::pipeline {
namespace {

// Input of a case: its text, the numbers that it begins with, and the text behind the first blank.
struct TextInput {
  explicit TextInput(const std::string& line)
      : text(with_all(with_all(with_all(line, "⏎", "\n"), "⇥", "\t"), "<empty>", "")),
        rest(text.substr(text.find(' ') + 1)) {
    std::istringstream words(text);
    for (std::string word; words >> word;) numbers.push_back(std::strtod(word.c_str(), nullptr));
  }
  Index index(std::size_t i) const { return static_cast<Index>(numbers.at(i)); }

  std::string text, rest;
  std::vector<double> numbers;
};

std::string made_of(const std::string& function, const TextInput& in) {
  using enum analysis::NumberStyle;
  const std::vector<double>& n = in.numbers;
  const std::map<std::string, std::function<std::string()>> functions = {
      {"html", [&] { return analysis::escape_html(in.text); }},
      {"markdown", [&] { return analysis::escape_markdown(in.text); }},
      {"latex", [&] { return analysis::escape_latex(in.text); }},
      {"csv", [&] { return analysis::quote_csv(in.text); }},
      {"latex symbols", [&] { return analysis::latex_symbols(in.text); }},
      {"symbol of a user", [&] { return analysis::is_latex_symbol(in.text) ? "yes" : "no"; }},
      {"mean and deviation", [&] { return analysis::mean_std_text(n.at(0), n.at(1), plain); }},
      {"mean and deviation in LaTeX",
       [&] { return analysis::mean_std_text(n.at(0), n.at(1), latex); }},
      {"number", [&] { return analysis::number_text(n.at(0), plain); }},
      {"number in LaTeX", [&] { return analysis::number_text(n.at(0), latex); }},
      {"footnote", [&] { return analysis::footnote_mark(static_cast<std::size_t>(n.at(0))); }},
      {"fitted", [&] { return fitted(in.rest, static_cast<int>(n.at(0))); }},
      {"wrapped", [&] { return wrapped(in.rest, static_cast<int>(n.at(0))); }},
      {"bar", [&] { return bar(n.at(0), static_cast<int>(n.at(1))); }},
      {"progress", [&] { return progress_text(in.index(0), in.index(1), n.at(2), in.index(3)); }},
      {"clock", [&] { return clock_text(n.at(0)); }},
      {"silence", [&] { return silence_text(n.at(0)); }},
      {"seconds of Slurm", [&] { return fmt::format("{:.0f}", seconds_of(in.text).value()); }},
      {"indices", [&] { return index_ranges(std::vector<Index>(n.begin(), n.end())); }},
      {"folder", [&] { return folder_slug(in.text); }},
      {"shell", [&] { return shell_text(split(in.text, '|')); }},
      {"figure text in lines",
       [&] { return join(analysis::wrap_text(in.rest, n.at(0), 10.0), "|"); }},
      {"figure text", [&] { return analysis::elide_text(in.rest, n.at(0), 10.0); }},
      {"quoted", [&] { return quoted(in.text); }},
      {"shortened", [&] { return shortened(in.text); }},
      {"fields of semicolons", [&] { return join(csv_fields(in.text, "x", ';'), "|"); }},
      {"hint of commas", [&] { return format_hint(in.text, {}); }},
      {"hint of semicolons",
       [&] {
         return format_hint(in.text, {';', false});
       }},
      {"hint of semicolons and decimal commas", [&] {
         return format_hint(in.text, {';', true});
       }}};
  const auto found = functions.find(function);
  return found == functions.end() ? "no such function" : found->second();
}

TEST(Golden, Text) {
  expect_golden("text", [](const GoldenCase& given) {
    return made_of(given.name, TextInput(given.input.front()));
  });
}

}  // namespace
}  // namespace npdr::pipeline
