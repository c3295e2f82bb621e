#include "pipeline/plan/shards.h"

#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

std::vector<Shard> shards(const Plan& plan, const Node& node) {
  std::vector<Shard> all;
  const Index n = num_rows(plan, node);
  const Index size = plan.study.simulate.shard_size;
  for (Index begin = 0; begin < n; begin += size) {
    const RowRange rows{begin, std::min(begin + size, n)};
    all.push_back({rows, plan.work.shard(node.key, rows)});
  }
  return all;
}

Index num_shards(const Plan& plan, const Node& node) {
  const Index size = plan.study.simulate.shard_size;
  return (num_rows(plan, node) + size - 1) / size;
}

std::vector<Index> missing_shards(const Plan& plan, const Node& node) {
  std::vector<Index> missing;
  Index number = 0;
  for (const Shard& shard : shards(plan, node)) {
    if (!std::filesystem::exists(shard.path)) missing.push_back(number);
    ++number;
  }
  return missing;
}

void require_shard(const Plan& plan, const Node& node, Index number) {
  const Index count = num_shards(plan, node);
  if (number >= 0 && number < count) return;
  throw InputError(
      fmt::format("--shard {}: {} has shards 0 to {}", number, node.label(), count - 1));
}

std::string too_many_failed(const Plan& plan, const Node& node, const h5::File& file) {
  const auto num_failed = file.attribute<Index>("num_failed");
  const Index n = num_rows(plan, node);
  const double limit = plan.study.limits.max_failed_fraction;
  if (static_cast<double>(num_failed) <= limit * static_cast<double>(n)) return "";
  const SourceTraits& source = plan.study.source();
  return fmt::format(
      "{}: {} of {} rows failed ({}), limits.max_failed_fraction = {} allows {}; {}, or raise the "
      "limit",
      node.path.string(), num_failed, n, failures(file), limit,
      static_cast<Index>(limit * static_cast<double>(n)), source.advice);
}

h5::File open_simulation(const Plan& plan, const Node& node) {
  h5::File file = open_artefact(node, kSimulationSchema);
  const std::string failure = too_many_failed(plan, node, file);
  if (!failure.empty()) throw FailedRolloutsError(failure);
  return file;
}

}  // namespace npdr::pipeline
