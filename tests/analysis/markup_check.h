/// A small check that HTML or SVG text is well-formed, for what the project writes itself.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace npdr::analysis {

/// Length of the name that `tag` ("/g", "path d='...'") begins with.
inline std::string_view tag_name(std::string_view tag) {
  return tag.substr(0, tag.find_first_of(" \t\r\n/"));
}

/// "" when every element is closed in order and quotes in tags are balanced; otherwise what is
/// wrong and where. Understands <?...?>, <!...> and <a/>; expects no comments or CDATA.
inline std::string markup_error(std::string_view text) {
  std::vector<std::string_view> open;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    std::size_t end = at + 1;
    for (char quote = 0; end < text.size() && (quote != 0 || text[end] != '>'); ++end) {
      if (text[end] == '<') return "'<' inside a tag at " + std::string(text.substr(at, 60));
      if (quote != 0) {
        if (text[end] == quote) quote = 0;
      } else if (text[end] == '"' || text[end] == '\'') {
        quote = text[end];
      }
    }
    if (end >= text.size()) return "unfinished tag at " + std::string(text.substr(at, 60));
    const std::string_view tag = text.substr(at + 1, end - at - 1);
    at = end;
    if (tag.starts_with('?') || tag.starts_with('!') || tag.ends_with('/')) continue;
    if (!tag.starts_with('/')) {
      open.push_back(tag_name(tag));
    } else if (open.empty() || open.back() != tag_name(tag.substr(1))) {
      std::string message = "closed out of order: ";
      return message.append(tag);
    } else {
      open.pop_back();
    }
  }
  std::string message = "not closed: ";
  return open.empty() ? "" : message.append(open.back());
}

/// Number of times that `what` stands in `text`.
inline int count_of(std::string_view text, std::string_view what) {
  int count = 0;
  for (std::size_t at = text.find(what); at != std::string_view::npos;
       at = text.find(what, at + what.size())) {
    ++count;
  }
  return count;
}

/// True when the file begins like a PNG.
inline bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1a\n"); }

}  // namespace npdr::analysis
