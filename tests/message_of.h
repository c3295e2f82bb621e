/// Messages of errors.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <type_traits>
#include <vector>

namespace npdr {

/// Message of the exception of type E that `body` throws; "" when it throws none.
template <class E, class Body>
std::string message_of(const Body& body) {
  try {
    body();
  } catch (const E& error) {
    return error.what();
  }
  return "";
}

/// Tells whether a message begins with the first of the parts and has the others behind it, in
/// their order and as whole words: where, what was found, what is allowed, what to do. It may use
/// more words, but no more lines.
inline testing::AssertionResult says(const std::string& message,
                                     const std::vector<std::string>& parts) {
  const auto goes_on = [&](std::size_t at) {
    const auto is_part = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
    const std::size_t next = at < message.size() && message[at] == '.' ? at + 1 : at;
    return is_part(message[at - 1]) && next < message.size() && is_part(message[next]);
  };
  std::size_t at = 0;
  std::ptrdiff_t num_lines = message.ends_with('\n') ? 1 : 0;
  for (const std::string& part : parts) {
    std::size_t found = message.find(part, at);
    while (found != std::string::npos && goes_on(found + part.size())) {
      found = message.find(part, found + 1);
    }
    if (found == std::string::npos || (at == 0 && found != 0)) {
      return testing::AssertionFailure() << "'" << part << "' isn't said by: " << message;
    }
    at = found + part.size();
    num_lines += std::ranges::count(part, '\n');
  }
  if (std::ranges::count(message, '\n') == num_lines) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "more lines than expected: " << message;
}

/// Tells whether a text holds all of the parts, wherever they stand.
inline testing::AssertionResult has(const std::string& text,
                                    const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (text.find(part) == std::string::npos) {
      return testing::AssertionFailure() << "'" << part << "' isn't in: " << text;
    }
  }
  return testing::AssertionSuccess() << "it is in: " << text;
}

template <class Part>
requires std::is_convertible_v<Part, std::string> testing::AssertionResult has(
    const std::string& text, const Part& part) {
  return has(text, std::vector<std::string>{part});
}

}  // namespace npdr
