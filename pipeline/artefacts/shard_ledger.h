/// Who made the shards of a simulation: the group `shards` of the joined file.
///
///   begin, end    (S) int64: the rows [begin, end) of each shard
///   failed        (S) int64: how many of them failed
///   host          (S) text: machine
///   batch_job     (S) text: id of the batch system's task, empty without one
///   wall_seconds, core_seconds  (S) float64
/// The group is volatile: two runs that computed the same thing differ in it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/artefacts/work_folder.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

class ShardLedger {
 public:
  /// The open shard of these rows, `failed` of which failed.
  void add(const h5::File& shard, RowRange rows, Index failed);

  void write(h5::File& simulation) const;

 private:
  std::vector<Index> begin_, end_, failed_;
  std::vector<std::string> host_, batch_job_;
  std::vector<double> wall_seconds_, core_seconds_;
};

}  // namespace npdr::pipeline
