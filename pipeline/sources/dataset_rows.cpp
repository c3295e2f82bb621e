#include "pipeline/sources/dataset_rows.h"

#include "core/feature_names.h"
#include "core/random.h"

namespace npdr::pipeline {

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
