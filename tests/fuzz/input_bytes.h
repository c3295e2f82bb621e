/// Bytes that a fuzzer makes up, taken as choices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace npdr::pipeline {

/// Takes bytes from the front; 0 when there are none left.
class InputBytes {
 public:
  explicit InputBytes(std::string_view bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }

  std::size_t byte() {
    if (bytes_.empty()) return 0;
    const auto value = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    return value;
  }

  /// One of 0, ..., count - 1.
  std::size_t below(std::size_t count) {
    std::size_t value = byte();
    if (count > 256) value = 256 * value + byte();
    return value % std::max<std::size_t>(1, count);
  }

  /// An element of a container that isn't empty.
  template <class C>
  auto& one_of(C& choices) {
    return *std::next(choices.begin(), static_cast<std::ptrdiff_t>(below(choices.size())));
  }

  /// At most 255 bytes, with their number first.
  std::string text() {
    const std::size_t count = byte();
    const std::string text(bytes_.substr(0, count));
    bytes_.remove_prefix(text.size());
    return text;
  }

  std::string_view rest() { return std::exchange(bytes_, {}); }

 private:
  std::string_view bytes_;
};

}  // namespace npdr::pipeline
