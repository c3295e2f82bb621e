#include "core/matrix_blocking.h"

#include <Eigen/Core>

namespace npdr {
namespace {

bool set_cache_sizes() {
  constexpr std::ptrdiff_t kibibyte = 1024;
  Eigen::setCpuCacheSizes(32 * kibibyte, 512 * kibibyte, 4096 * kibibyte);
  return true;
}

}  // namespace

void fix_matrix_blocking() { [[maybe_unused]] static const bool once = set_cache_sizes(); }

}  // namespace npdr
