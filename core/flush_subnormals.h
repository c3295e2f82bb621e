/// Arithmetic without subnormal numbers, for loops where they mean nothing and cost much.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace npdr {

/// Takes subnormal numbers (below 1.2e-38 in single precision) for zero on this thread, in operands
/// and results, for as long as the object lives. Each operation with one costs x86 processors a
/// hundred times the usual: responsibilities and gradients that vanish are of that kind. Other
/// processors compute with them. Threads that are begun meanwhile take it over, and keep it: begin
/// none.
class [[maybe_unused]] FlushSubnormals {
 public:
#if defined(__SSE2__)
  FlushSubnormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | kFlushToZero | kZeroOperands); }
  ~FlushSubnormals() { _mm_setcsr(before_); }
#else
  FlushSubnormals() = default;
#endif
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned kFlushToZero = 0x8000, kZeroOperands = 0x0040;
  unsigned before_;
#endif
};

}  // namespace npdr
