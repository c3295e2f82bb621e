#include "core/eigen_kernels.h"

namespace Eigen::internal {

NPDR_EIGEN_KERNELS(, float)
NPDR_EIGEN_KERNELS(, double)

}  // namespace Eigen::internal
