#include "pipeline/artefacts/shard_ledger.h"

#include "pipeline/store/artefact.h"

namespace npdr::pipeline {
namespace {

template <class T>
VectorX<T> as_vector(const std::vector<T>& values) {
  return Eigen::Map<const VectorX<T>>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace

void ShardLedger::add(const h5::File& shard, RowRange rows, Index failed) {
  const Provenance provenance = provenance_of(shard);
  begin_.push_back(rows.begin);
  end_.push_back(rows.end);
  failed_.push_back(failed);
  host_.push_back(provenance.host);
  batch_job_.push_back(provenance.batch_job);
  wall_seconds_.push_back(provenance.cost.wall_seconds);
  core_seconds_.push_back(provenance.cost.core_seconds);
}

void ShardLedger::write(h5::File& simulation) const {
  h5::Group group = simulation.create_group("shards");
  mark_volatile(group);
  group.write("begin", as_vector(begin_));
  group.write("end", as_vector(end_));
  group.write("failed", as_vector(failed_));
  group.write_texts("host", host_);
  group.write_texts("batch_job", batch_job_);
  group.write("wall_seconds", as_vector(wall_seconds_));
  group.write("core_seconds", as_vector(core_seconds_));
}

}  // namespace npdr::pipeline
