/// Answers of an amortized posterior to many simulations with known parameters: the raw material of
/// sbc.h, coverage.h and local_c2st.h, and the density of the truths, whose mean is largest for the
/// posterior that is right (a strictly proper score; Gneiting and Raftery 2007). Each observation
/// is sampled once for all of them.
#pragma once

#include <functional>
#include <memory>

#include "inference/posterior.h"

namespace npdr::inference {

/// Ranks of n simulations, in their order, of which the first `num_done` are there. They count
/// among `num_samples` samples.
struct CalibrationRanks {
  Index num_samples = 0;
  Index num_done = 0;
  RowMatrixX<std::int64_t> parameter = {};  ///< (n, D) how many samples are smaller, per parameter
  VectorX<std::int64_t> density = {};       ///< (n) how many samples are more likely
  VectorX<std::int64_t> distance = {};      ///< (n) how many are nearer to a draw of the prior
  RowMatrix theta = {};                     ///< (n, D) one sample of each posterior
  Vector log_prob = {};  ///< (n) density of the truths [nats]; NaN: a normaliser would cost more

  /// Makes room for n simulations; those that are done stay.
  void resize(Index n, Index dimension);
};

/// The posterior given x (F).
using AmortizedPosterior = std::function<std::unique_ptr<Posterior>(const VectorF& x)>;

/// Called after each simulation; may throw to stop.
using CalibrationHook = std::function<void(const CalibrationRanks& ranks)>;

/// Draws from the posterior given each row of x (n, F), whose parameters are the rows of theta
/// (n, D), and ranks these; goes on after the first `earlier.num_done` ones. Densities are those of
/// theta; distances are taken where the prior is N(0, I). Simulation i depends on `id` and i alone.
/// Throws ShapeError when shapes don't go together.
CalibrationRanks rank_truths(const AmortizedPosterior& posterior_given, const RowMatrix& theta,
                             const RowMatrixF& x, CalibrationRanks earlier, const StreamId& id,
                             const CalibrationHook& hook = {});

}  // namespace npdr::inference
