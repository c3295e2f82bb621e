/// The interface of conditional density estimators q(u | c).
///
/// u: (n k, D), the parameters in the space where the prior is N(0, I) (prior.h).
/// c: (n, F), the context: one row of features per simulation. k values of u share a context row:
/// row i of u belongs to context row i / k. So an x is processed once for all of its atoms.
/// Networks are templates on the scalar: float to train, double to check gradients.
#pragma once

#include <memory>

#include "core/random.h"
#include "core/types.h"
#include "inference/estimators/estimator_config.h"
#include "inference/estimators/parameters.h"

namespace npdr::inference {

/// Memory of a forward pass for the backward pass; one per thread.
struct EstimatorScratch {
  virtual ~EstimatorScratch() = default;
};

/// A conditional density: its architecture, without its weights, which callers own.
/// Const calls are thread-safe; each thread brings a scratch of its own.
template <typename S>
class DensityEstimator {
 public:
  virtual ~DensityEstimator() = default;

  virtual Index dimension() const = 0;         ///< D
  virtual Index context_features() const = 0;  ///< F

  /// Writes random weights with which q starts near the prior, q(u | c) ~ N(0, I), to the
  /// estimator's own blocks of `parameters`.
  virtual void initialize(Parameters<S>& parameters, Stream& stream) const = 0;

  virtual std::unique_ptr<EstimatorScratch> make_scratch() const = 0;

  /// log q(u | c) in nats into `log_prob` (n k), and keeps in `scratch` what backward() needs.
  virtual void log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                        const RowMatrixX<S>& context, EstimatorScratch& scratch,
                        VectorX<S>& log_prob) const = 0;

  /// Given dL/dlog_prob (n k) of the last log_prob() call, overwrites the estimator's own blocks of
  /// `gradient` with dL/dparameters and, unless it is null, `d_context` with dL/dcontext (n, F).
  virtual void backward(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                        const RowMatrixX<S>& context, const VectorX<S>& d_log_prob,
                        EstimatorScratch& scratch, Parameters<S>& gradient,
                        RowMatrixX<S>* d_context) const = 0;

  /// (count, D): samples of q(. | c) for one context (1, F). Sample i draws from the stream of row
  /// id.row + i.
  virtual RowMatrixX<S> sample(const Parameters<S>& parameters, const RowMatrixX<S>& context,
                               Index count, const StreamId& id) const = 0;
};

/// The estimator of a config, with its blocks taken from `layout`. `structure` seeds what is random
/// in the architecture (the order of the variables in a flow). Throws InputError for an unknown
/// kind or an impossible size.
template <typename S>
std::unique_ptr<DensityEstimator<S>> make_estimator(const EstimatorConfig& config, Index dimension,
                                                    Index context_features,
                                                    const StreamId& structure,
                                                    ParameterLayout& layout);

}  // namespace npdr::inference
