#include "core/printable.h"

#include <algorithm>
#include <cstdint>

namespace npdr {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

// The first character of a text, and how many bytes it has; 0: they aren't UTF-8 (RFC 3629).
struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;
};

Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < size) return {};
  std::uint32_t code = lead & (0x7Fu >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  constexpr std::uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < smallest[size] || code > 0x10FFFF || is_surrogate) return {};
  return {code, size};
}

bool is_harmless(std::uint32_t code) {
  struct Codes {
    std::uint32_t first, last;
  };
  constexpr Codes harmful[] = {
      {0x00, 0x1F},      // controls, and
      {0x7F, 0x9F},      // more of them
      {0x061C, 0x061C},  // the direction of text: the Arabic mark,
      {0x200E, 0x200F},  // the others,
      {0x2028, 0x202E},  // (separators of lines and paragraphs) embeddings, overrides
      {0x2066, 0x2069},  // and isolates
      {0xFEFF, 0xFEFF},  // the byte order mark
      {0xFFFE, 0xFFFF},  // no characters
  };
  return std::ranges::none_of(
      harmful, [code](const Codes& range) { return code >= range.first && code <= range.last; });
}

std::string replaced(std::string_view text, std::string_view allowed) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_character(text);
    const std::size_t size = std::max<std::size_t>(c.size, 1);
    const bool is_kept =
        c.size > 0 && (is_harmless(c.code) || allowed.find(text[0]) != std::string_view::npos);
    result += is_kept ? text.substr(0, size) : kReplacement;
    text.remove_prefix(size);
  }
  return result;
}

}  // namespace

std::string printable(std::string_view text) { return replaced(text, "\n\t"); }

std::string printable_line(std::string_view text) { return replaced(text, ""); }

}  // namespace npdr
