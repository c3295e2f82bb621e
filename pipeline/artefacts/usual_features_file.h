/// What x of its simulations usually is, in the artefact of a posterior.
#pragma once

#include <optional>

#include "inference/diagnostics/out_of_distribution.h"
#include "pipeline/artefacts/layout.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// The group `usual`; missing of fewer than inference::kFewestSimulations.
void describe(Layout f, std::optional<inference::UsualFeatures>& usual);

/// Throws InputError.
std::optional<inference::UsualFeatures> read_usual_features(const ArtefactFile& posterior);

}  // namespace npdr::pipeline
