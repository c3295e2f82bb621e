#include "pipeline/external/dataset_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/feature_names.h"
#include "core/random.h"

namespace npdr::pipeline {

std::vector<Index> dataset_rows(std::uint64_t seed, Index num_rows, Index count) {
  Stream stream({seed, "dataset_rows", 0, 0, 0});
  const auto order = stream.permutation(static_cast<std::uint32_t>(num_rows));
  std::vector<Index> rows(order.begin(), order.begin() + count);
  std::ranges::sort(rows);
  return rows;
}

DatasetFile open_dataset(const Study& study) {
  std::vector<std::string> parameters;
  for (const inference::Marginal& marginal : study.prior) parameters.push_back(marginal.name);
  return {*study.external.dataset, parameters, parse_features(study.external.features)};
}

sim::Trajectories as_simulated(const Study& study, const RowMatrix& theta, const RowMatrix& x) {
  const inference::Prior prior(study.prior);
  sim::Trajectories result;
  result.resize(x.rows(), 1, 1, x.cols());
  for (Index i = 0; i < x.rows(); ++i) {
    const std::span<float> row = result.row(i);
    std::ranges::transform(x.row(i), row.begin(), [](double v) { return static_cast<float>(v); });
    sim::RolloutStatus& status = result.status[static_cast<std::size_t>(i)];
    if (!std::ranges::all_of(row, [](float v) { return std::isfinite(v); })) {
      status = sim::RolloutStatus::diverged;
    } else if (!prior.contains(theta.row(i).transpose())) {
      status = sim::RolloutStatus::out_of_limits;
    }
    if (status == sim::RolloutStatus::ok) continue;
    std::ranges::fill(row, std::numeric_limits<float>::quiet_NaN());
  }
  return result;
}

}  // namespace npdr::pipeline
