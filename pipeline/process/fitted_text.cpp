#include "pipeline/process/fitted_text.h"

#include <algorithm>
#include <sstream>

namespace npdr::pipeline {
namespace {

// Columns of the character that begins with this byte of UTF-8; 0: it goes on with it.
int columns_of(char byte) {
  const auto value = static_cast<unsigned char>(byte);
  if ((value & 0xC0) == 0x80) return 0;
  return value >= 0xE3 ? 2 : 1;
}

int width_of(const std::string& text) {
  int width = 0;
  for (const char byte : text) width += columns_of(byte);
  return width;
}

}  // namespace

std::string fitted(const std::string& text, int columns) {
  if (width_of(text) <= columns) return text;
  const int room = std::max(0, columns - 3);
  std::size_t end = 0;
  for (int used = 0; end < text.size() && used + columns_of(text[end]) <= room; ++end) {
    used += columns_of(text[end]);
  }
  return text.substr(0, end) + std::string("...").substr(0, static_cast<std::size_t>(columns));
}

std::string wrapped(const std::string& text, int columns) {
  const std::string indent = text.substr(0, std::min(text.find_first_not_of(' '), text.size()));
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && width_of(line) + 1 + width_of(word) > columns) {
      lines += line + "\n";
      line.clear();
    }
    line += (line.empty() ? indent : " ") + word;
  }
  return lines + line;
}

}  // namespace npdr::pipeline
