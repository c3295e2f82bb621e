/// The atomic proposal posterior of NPE-C (APT).
///
/// Source: Greenberg, Nonnenmacher and Macke 2019, "Automatic posterior transformation for
/// likelihood-free inference", eq. 7 and section 2.3. With k atoms u_0 (the true one), ..., u_{k-1}
/// for an x and r_a = log q(u_a | x) - log p(u_a),
///   loss = -log [ exp(r_0) / sum_a exp(r_a) ].
#pragma once

#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Draws k - 1 distinct others of the n rows for each of them, uniformly; (n k) indices into the
/// batch, the row itself first. Throws ShapeError when k > n.
std::vector<std::uint32_t> draw_atoms(Index n, Index k, Stream& stream);

/// Mean loss over n rows with k atoms each. log_prob, log_prior: (n k), atom 0 the true one.
/// d_log_prob (n k) receives dloss/dlog_prob.
template <typename S>
double atomic_loss(const VectorX<S>& log_prob, const VectorX<S>& log_prior, Index k,
                   VectorX<S>& d_log_prob);

}  // namespace npdr::inference
