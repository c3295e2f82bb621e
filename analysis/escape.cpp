#include "analysis/escape.h"

#include <algorithm>
#include <charconv>
#include <span>
#include <system_error>
#include <utility>

#include "analysis/latex_symbols.h"
#include "core/printable.h"

namespace npdr::analysis {
namespace {

using Substitution = std::pair<char, std::string_view>;

constexpr Substitution kHtml[] = {
    {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};

constexpr Substitution kMarkdown[] = {{'\\', "\\\\"}, {'|', "\\|"}, {'*', "\\*"}, {'`', "\\`"},
                                      {'<', "\\<"},   {'\n', " "},  {'\r', " "}};

constexpr Substitution kLatex[] = {{'\\', "\\textbackslash{}"},
                                   {'~', "\\textasciitilde{}"},
                                   {'^', "\\textasciicircum{}"},
                                   {'<', "\\textless{}"},
                                   {'>', "\\textgreater{}"},
                                   {'{', "\\{"},
                                   {'}', "\\}"},
                                   {'$', "\\$"},
                                   {'&', "\\&"},
                                   {'#', "\\#"},
                                   {'_', "\\_"},
                                   {'%', "\\%"},
                                   {'|', "\\textbar{}"},
                                   {'[', "{[}"},  // else an argument of the row that ends before it
                                   {'*', "{*}"},
                                   {'\n', " "},
                                   {'\r', " "}};

std::string substitute(std::string_view text, std::span<const Substitution> substitutions) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    const auto found = std::find_if(substitutions.begin(), substitutions.end(),
                                    [c](const Substitution& s) { return s.first == c; });
    if (found == substitutions.end()) {
      result += c;
    } else {
      result += found->second;
    }
  }
  return printable(result);
}

bool is_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string escape_html(std::string_view text) { return substitute(text, kHtml); }

std::string escape_markdown(std::string_view text) { return substitute(text, kMarkdown); }

std::string escape_latex(std::string_view text) { return latex_symbols(substitute(text, kLatex)); }

std::string quote_csv(std::string_view text) {
  constexpr std::string_view formula = "=+-@";
  const bool is_formula =
      text.size() > 1 && formula.find(text[0]) != std::string_view::npos && !is_number(text);
  const std::string shown = (is_formula ? "'" : "") + printable(text);
  if (shown.find_first_of(",\"\n") == std::string::npos) return shown;
  constexpr Substitution doubled[] = {{'"', "\"\""}};
  return '"' + substitute(shown, doubled) + '"';
}

}  // namespace npdr::analysis
