/// Text from files and other programs, made harmless for people's terminals and pages.
#pragma once

#include <string>
#include <string_view>

namespace npdr {

/// `text` as UTF-8 that only shows something: each byte that isn't UTF-8, each control character
/// (but for line breaks and tabulators), and each character that turns the direction of those after
/// it or breaks lines unseen becomes U+FFFD, the replacement character.
std::string printable(std::string_view text);

/// The same on one line: line breaks and tabulators are replaced, too.
std::string printable_line(std::string_view text);

}  // namespace npdr
