/// Baseline artefacts: what single parameter vectors reach, to compare posteriors with.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "inference/prior.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

struct BaselinePoint {
  std::string name;
  Vector theta;                           ///< (D)
  std::map<std::string, double> metrics;  ///< NaN when the rollout failed
};

/// Throws Error.
void write_baseline(h5::File& file, const std::vector<inference::Marginal>& prior,
                    const std::vector<BaselinePoint>& points);
/// Throws InputError.
std::vector<BaselinePoint> read_baseline(const ArtefactFile& baseline);

}  // namespace npdr::pipeline
