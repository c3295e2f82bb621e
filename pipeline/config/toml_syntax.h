/// Syntax of a study's text, before and after toml++ has read it. Private to pipeline/config.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "pipeline/config/reading.h"

namespace npdr::pipeline {

// toml++ destroys nested tables recursively; a key of very many parts would overflow the stack.
inline constexpr std::ptrdiff_t kMaxDotsOfFile = 4'999;  // of up to 9998 levels, in 4 MB of stack
inline constexpr std::ptrdiff_t kMaxDotsOfOverride = 1'000;

/// Throws InputError where `text` has more dots than `limit`, beside those of numbers.
void require_few_dots(std::string_view text, std::ptrdiff_t limit);

/// A syntax error as "s.toml:2:8: NPE is no number, true or false; text needs quotes: \"NPE\"".
/// `place` and `description`: those of toml++, which doesn't name missing quotes.
std::string words_of_syntax_error(std::string_view text, Place place, std::string_view description);

}  // namespace npdr::pipeline
