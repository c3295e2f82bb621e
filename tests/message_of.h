/// What errors say.
#pragma once

#include <string>

namespace npdr {

/// What the exception of type E that `body` throws says; "" when it throws none.
template <class E, class Body>
std::string message_of(const Body& body) {
  try {
    body();
  } catch (const E& error) {
    return error.what();
  }
  return "";
}

}  // namespace npdr
