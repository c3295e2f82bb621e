/// The N_Vector that holds the state of a whole batch for SUNDIALS.
///
/// S states of L lanes in structure-of-arrays order (S, L), L a multiple of kLaneBlock, aligned to
/// a cache line. It is SUNDIALS' serial N_Vector with other operations where a fixed-step ERKStep
/// spends its time, compiled with the flags of this project (a packaged libsundials is built for
/// the oldest processor it runs on):
///   clone              keeps the alignment
///   linear combination z = sum_k c_k x_k in one pass, leaving out terms with c_k = 0
///   scale              z = c x
///   WRMS norm          always 0
/// The norm weighs errors of one system against its tolerances. Over a batch it has no meaning, and
/// a lane that diverges would make it NaN and stop the others; a fixed step needs no norm.
#pragma once

#include <sundials/sundials_context.h>
#include <sundials/sundials_nvector.h>

#include <memory>
#include <type_traits>

#include "core/types.h"

namespace npdr::sim {

struct ContextDeleter {
  void operator()(SUNContext context) const;
};
/// A SUNContext serves one thread at a time: every integrator has its own.
using ContextPtr = std::unique_ptr<std::remove_pointer_t<SUNContext>, ContextDeleter>;
ContextPtr make_context();

struct VectorDeleter {
  void operator()(N_Vector vector) const;
};
using VectorPtr = std::unique_ptr<std::remove_pointer_t<N_Vector>, VectorDeleter>;

/// A batch vector of `size` = S * L doubles, all 0. Throws ShapeError unless size is a positive
/// multiple of kLaneBlock.
VectorPtr make_batch_vector(Index size, SUNContext context);

/// The (S, L) values of a vector.
double* values(N_Vector vector);

}  // namespace npdr::sim
