#include "inference/posterior.h"

#include <algorithm>
#include <limits>
#include <nlopt.hpp>

#include "core/error.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

Vector Posterior::best_sample(const StreamId& id) const {
  constexpr Index num_samples = 1000;
  const RowMatrix theta = sample(num_samples, id);
  Index best = 0;
  if (!std::isfinite(numbers(relative_log_prob(theta)).maxCoeff(&best))) {
    throw Error("posterior: its density is no number above 0 at any of its samples");
  }
  return theta.row(best).transpose();
}

Vector Posterior::map(const StreamId& id) const {
  constexpr int max_evaluations = 3000;
  constexpr double farthest = 8.0;  // |u_d|, which the prior's is beyond with probability 1e-15
  const RowMatrix start = prior().to_normal(best_sample(id).transpose());
  const Index d = start.cols();

  nlopt::opt search(nlopt::LN_SBPLX, static_cast<unsigned>(d));
  search.set_lower_bounds(-farthest);
  search.set_upper_bounds(farthest);
  search.set_initial_step(0.1);
  search.set_xtol_rel(1e-6);
  search.set_maxeval(max_evaluations);
  const nlopt::vfunc objective = [](const std::vector<double>& u, std::vector<double>&,
                                    void* self) {
    const auto& posterior = *static_cast<const Posterior*>(self);
    const auto width = static_cast<Index>(u.size());
    const RowMatrix theta =
        posterior.prior().to_theta(Eigen::Map<const RowMatrix>(u.data(), 1, width));
    const double value = posterior.relative_log_prob(theta)(0);
    return std::isfinite(value) ? value : std::numeric_limits<double>::lowest();
  };
  search.set_max_objective(objective, const_cast<Posterior*>(this));
  std::vector<double> u(start.data(), start.data() + d);
  for (double& value : u) value = std::clamp(value, -farthest, farthest);
  double value = 0.0;
  search.optimize(u, value);
  return prior().to_theta(Eigen::Map<const RowMatrix>(u.data(), 1, d)).row(0).transpose();
}

}  // namespace npdr::inference
