/// Text in the columns of a terminal. Characters from U+3000 on count two.
#pragma once

#include <string>

namespace npdr::pipeline {

/// `text` in at most that many columns, its end replaced by "..." where it is longer.
std::string fitted(const std::string& text, int columns);

/// The words of `text` in lines of at most that many columns, or of a single longer word; each line
/// begins with the blanks that the first one begins with.
std::string wrapped(const std::string& text, int columns);

}  // namespace npdr::pipeline
