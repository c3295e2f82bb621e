#include "pipeline/config/toml_syntax.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

// But for those of numbers, between digits and the only one of its word. Every other dot of a key
// counts at least: "1.1 . 1.1".
std::ptrdiff_t count_dots(std::string_view text) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::ptrdiff_t all = 0;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n,=[]{}"));
    const std::ptrdiff_t dots = std::ranges::count(word, '.');
    const std::size_t dot = word.find('.');
    const bool is_number = dots == 1 && dot > 0 && dot + 1 < word.size() &&
                           is_digit(word[dot - 1]) && is_digit(word[dot + 1]);
    if (!is_number) all += dots;
    text.remove_prefix(std::min(word.size() + 1, text.size()));
  }
  return all;
}

bool is_letter(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalpha(byte) != 0 || byte >= 0x80;
}

// Lines count from 1.
std::string line_of(std::string_view text, int number) {
  for (; number > 1; --number) {
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  return std::string(line);
}

// toml++ counts characters from 1, which have several bytes each.
std::size_t byte_of(std::string_view line, int column) {
  std::size_t byte = 0;
  for (int c = 1; c < column && byte < line.size(); ++c) {
    do ++byte;
    while (byte < line.size() && (static_cast<unsigned char>(line[byte]) & 0xC0) == 0x80);
  }
  return byte;
}

bool is_value(const std::string& text) {
  try {
    return !toml::parse("value = " + text).empty();
  } catch (const toml::parse_error&) {
    return false;
  }
}

struct BareText {
  std::size_t before;  // bytes of the line
  std::string text;
};

// The value that an error is in, or right behind it, where that is a text without quotes.
std::optional<BareText> find_bare_text(const std::string& line, std::size_t error) {
  const std::size_t mark = line.substr(0, error).find_last_of("=,[{");
  const std::string before = line.substr(0, std::min(mark, error));
  const bool is_quoted = std::ranges::count(before, '"') % 2 + std::ranges::count(before, '\'') % 2;
  if (is_quoted) return std::nullopt;                                 // a quote is missing
  const std::size_t begin = line.find_first_not_of(" \t", mark + 1);  // npos + 1 is 0
  if (begin == std::string::npos) return std::nullopt;
  const std::size_t end = std::min(line.find_first_of(",]}#", begin), line.size());
  const std::string text = trimmed(line.substr(begin, end - begin));
  const bool is_list = end < line.size() && line[end] != '#';
  const bool is_header = line.find('=') > begin && line.find('[') < begin;
  if (mark == std::string::npos ? !is_list : is_header) return std::nullopt;
  const bool is_bare = !text.empty() && text.find_first_of("=\"[{") == std::string::npos &&
                       text.front() != '\'' && std::ranges::any_of(text, is_letter);
  return is_bare && !is_value(text) ? std::optional(BareText{begin, text}) : std::nullopt;
}

}  // namespace

void require_few_dots(std::string_view text, std::ptrdiff_t limit) {
  const std::ptrdiff_t dots = count_dots(text);
  if (dots <= limit) return;
  throw InputError(fmt::format(
      "holds {} dots beside those of numbers, more than a study needs ({})", dots, limit));
}

std::string words_of_syntax_error(std::string_view text, Place place,
                                  std::string_view description) {
  const std::string line = line_of(text, place.line);
  if (const auto bare = find_bare_text(line, byte_of(line, place.column))) {
    const std::string value = shortened(bare->text);
    const std::string before = line.substr(0, bare->before);
    place.column = 1 + static_cast<int>(std::ranges::count_if(before, [](char c) {
                     return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
                   }));
    return fmt::format("{}: {} is no number, true or false; text needs quotes: \"{}\"", place.str(),
                       value, value);
  }
  const bool is_second = line.starts_with('[') && description.find("redefine") != std::string::npos;
  return fmt::format(
      "{}: {}{}", place.str(), description,
      is_second ? "; a table stands once, each of several methods is [[method]]" : "");
}

}  // namespace npdr::pipeline
