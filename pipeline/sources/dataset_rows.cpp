#include "pipeline/sources/dataset_rows.h"

#include "core/feature_names.h"
#include "core/random.h"
#include "pipeline/sources/row_simulator.h"

namespace npdr::pipeline {

sim::Trajectories as_simulated(const inference::Prior& prior, const RowMatrix& theta,
                               const RowMatrix& x) {
  const sim::Segments segments = feature_segments(x.cols());
  sim::Trajectories result = sim::empty_trajectories(segments, x.rows(), 1);
  for (Index i = 0; i < x.rows(); ++i) {
    if (prior.contains(theta.row(i).transpose())) {
      sim::store_states(segments, x.row(i).data(), 1, i, result);
    } else {
      sim::lose_row(i, sim::RolloutStatus::out_of_limits, result);
    }
  }
  return result;
}

std::vector<Index> dataset_rows(std::uint64_t seed, Index num_rows, Index count) {
  Stream stream({seed, "dataset_rows", 0, 0, 0});
  const auto order = stream.permutation(static_cast<std::uint32_t>(num_rows));
  return {order.begin(), order.begin() + count};
}

DatasetFile open_dataset(const Study& study) {
  std::vector<std::string> parameters;
  for (const inference::Marginal& marginal : study.prior) parameters.push_back(marginal.name);
  return {*study.external.dataset, parameters, parse_features(study.external.features)};
}

}  // namespace npdr::pipeline
