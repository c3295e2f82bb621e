#include "analysis/latex_symbols.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>

namespace npdr::analysis {
namespace {

constexpr std::size_t kLongestSymbol = 60;  // bytes

// Bytes of the character that begins with `lead`, in UTF-8.
std::size_t size_of(char lead) {
  const auto byte = static_cast<unsigned char>(lead);
  return byte < 0x80 ? 1 : byte < 0xE0 ? 2 : byte < 0xF0 ? 3 : 4;
}

std::uint32_t code_of(std::string_view character) {
  std::uint32_t code = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return code;
  code &= 0x7Fu >> character.size();
  for (const char c : character.substr(1)) {
    code = code << 6 | (static_cast<unsigned char>(c) & 0x3Fu);
  }
  return code;
}

using Symbols = std::map<std::string, std::string, std::less<>>;

// Adds the characters of `all`, the k-th as pattern of the k-th word.
void add(Symbols& symbols, std::string_view all, std::string_view words, const char* pattern) {
  while (!all.empty()) {
    const std::size_t size = size_of(all[0]), end = std::min(words.find(' '), words.size());
    symbols[std::string(all.substr(0, size))] =
        fmt::format(fmt::runtime(pattern), words.substr(0, end));
    all.remove_prefix(size);
    words.remove_prefix(std::min(end + 1, words.size()));
  }
}

Symbols make_symbols() {
  Symbols symbols = {{"–", "--"},       {"—", "---"},       {"…", "\\ldots{}"}, {"‘", "`"},
                     {"’", "'"},        {"“", "``"},        {"”", "''"},        {"\u00A0", "~"},
                     {"\u2009", "\\,"}, {"°", "$^\\circ$"}, {"\uFFFD", "?"}};
  add(symbols, "±×·≥≤≠≈∞√−→←∂∈∑µ∝",
      "pm times cdot geq leq neq approx infty surd - rightarrow leftarrow "
      "partial in sum mu propto",
      "$\\{}$");
  symbols["−"] = "$-$";
  add(symbols, "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ⁿ", "0 1 2 3 4 5 6 7 8 9 - + n", "$^{{{}}}$");
  add(symbols, "₀₁₂₃₄₅₆₇₈₉", "0 1 2 3 4 5 6 7 8 9", "$_{{{}}}$");
  add(symbols, "αβγδεζηθικλμνξπρστυφχψωΓΔΘΛΞΠΣΦΨΩ",
      "alpha beta gamma delta varepsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma "
      "tau "
      "upsilon varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega",
      "$\\{}$");
  return symbols;
}

// Letters with accents that even the oldest font encoding composes.
bool is_latin_letter(std::uint32_t code) {
  const bool is_rune = code == 0xD0 || code == 0xDE || code == 0xF0 || code == 0xFE;
  return code >= 0xC0 && code <= 0xFF && code != 0xD7 && code != 0xF7 && !is_rune;
}

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Of users' symbols.
constexpr std::string_view kPlain = "{}(),.'+-*/ ";
constexpr std::string_view kLetters =
    " alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi "
    "pi rho sigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma "
    "Upsilon Phi Psi Omega log ell ";
constexpr std::string_view kAccents = " dot ddot bar hat tilde vec mathrm mathbf mathit ";

// `is_applied`: a brace follows.
bool is_command(std::string_view name, bool is_applied) {
  const std::string word = fmt::format(" {} ", name);
  return kLetters.find(word) != kLetters.npos ||
         (is_applied && kAccents.find(word) != kAccents.npos);
}

}  // namespace

std::string latex_symbols(std::string_view text) {
  static const Symbols symbols = make_symbols();
  std::string result;
  while (!text.empty()) {
    const std::string_view character = text.substr(0, size_of(text[0]));
    const std::uint32_t code = code_of(character);
    const auto known = symbols.find(character);
    if (known != symbols.end()) {
      result += known->second;
    } else if (code < 0x80 || is_latin_letter(code)) {
      result += character;
    } else {
      result += fmt::format("U+{:04X}", code);
    }
    text.remove_prefix(character.size());
  }
  return result;
}

bool is_latex_symbol(std::string_view text) {
  if (text.empty() || text.size() > kLongestSymbol) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i + 1);
    if (text[i] == '\\') {
      const auto end = std::ranges::find_if_not(rest, is_letter);
      const std::string_view name = rest.substr(0, static_cast<std::size_t>(end - rest.begin()));
      if (!is_command(name, end != rest.end() && *end == '{')) return false;
      i += name.size();
    } else if (text[i] == '_' || text[i] == '^') {
      const char next = rest.empty() ? ' ' : rest.front();
      if (!is_letter(next) && !is_digit(next) && next != '{' && next != '\\') return false;
    } else if (!is_letter(text[i]) && !is_digit(text[i]) && kPlain.find(text[i]) == kPlain.npos) {
      return false;
    }
  }
  int depth = 0;
  for (const char c : text) {
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (depth < 0) return false;
  }
  // LaTeX has no second subscript on the same letter.
  return depth == 0 && std::ranges::count(text, '_') <= 1 && std::ranges::count(text, '^') <= 1;
}

}  // namespace npdr::analysis
