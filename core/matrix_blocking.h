/// Blocks that Eigen cuts matrix products into.
#pragma once

namespace npdr {

/// Eigen cuts a product by the sizes of the caches, which it asks the CPU for: two nodes of a
/// cluster could add up the same product in another order, with other bits. From the first call on
/// it takes fixed sizes (32 KiB, 512 KiB and 4 MiB). To be called before any product whose bits
/// matter; thread-safe.
void fix_matrix_blocking();

}  // namespace npdr
