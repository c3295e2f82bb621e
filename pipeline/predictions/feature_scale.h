/// The coordinates in which predicted features are compared with those that were observed.
#pragma once

#include "inference/feature_transform.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Features in units of their deviation over the rows of `simulation` that didn't fail, without
/// observation noise; `tails`: what becomes of those that span orders of magnitude. Rows are read
/// in blocks. Where all have failed no feature varies. Throws InputError for a damaged artefact.
inference::FeatureTransform scale_of_features(const Node& simulation, inference::Tails tails);

}  // namespace npdr::pipeline
