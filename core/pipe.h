/// Pipes of the operating system.
#pragma once

#include <array>

namespace npdr {

/// Both ends of a pipe, which no program gets that this process becomes or starts; closed unless
/// they are taken. Throws Error when there can't be one.
class Pipe {
 public:
  Pipe();
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe();

  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_write_end();
  /// Gives up one end, which from now on never blocks.
  int take(int end);

 private:
  std::array<int, 2> ends_ = {-1, -1};
};

}  // namespace npdr
