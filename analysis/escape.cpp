#include "analysis/escape.h"

#include <algorithm>
#include <span>
#include <utility>

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
  return result;
}

}  // namespace

std::string escape_html(std::string_view text) { return substitute(text, kHtml); }

std::string escape_markdown(std::string_view text) { return substitute(text, kMarkdown); }

std::string escape_latex(std::string_view text) { return substitute(text, kLatex); }

std::string quote_csv(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  constexpr Substitution doubled[] = {{'"', "\"\""}};
  return '"' + substitute(text, doubled) + '"';
}

}  // namespace npdr::analysis
