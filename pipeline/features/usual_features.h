/// What x of a study's simulations usually is, for the test of observations among them.
#pragma once

#include <optional>

#include "core/random.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "inference/feature_source.h"

namespace npdr::pipeline {

/// That of at most `most_rows` of them, 80 or more, which `stream` picks; of fewer, but 80, where
/// they have more than 10,000 features. `tails`: as the posterior's networks see them. What isn't
/// finite is left out; none of fewer than inference::kFewestSimulations.
std::optional<inference::UsualFeatures> usual_features_of(const inference::FeatureSource& features,
                                                          inference::Tails tails, Index most_rows,
                                                          const StreamId& stream);

}  // namespace npdr::pipeline
