/// The group 'transform' of posterior artefacts: what features go through (feature_transform.h).
///
///   transform/mean, transform/inverse_deviation (F), transform/basis (F, k) where there is one
#pragma once

#include "inference/feature_transform.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

void write_transform(h5::File& file, const inference::FeatureTransform& transform);

/// `features`: F, -1 for any. Throws InputError.
inference::FeatureTransform read_transform(const h5::File& file, Index features = -1);

}  // namespace npdr::pipeline
