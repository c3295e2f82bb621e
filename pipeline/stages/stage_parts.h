/// Parts of stages in files of their own. Private to pipeline/stages.
///
/// How the stage 'infer' makes a posterior, by the family of the algorithm: each fills the artefact
/// of `node`; the caller finishes it. Throws as run_infer() does.
#pragma once

#include "inference/diagnostics/training_check.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/plan/plan.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// The posterior after one round of approximate Bayesian computation.
void infer_abc(const Plan& plan, const Node& node, h5::File& file);

/// The posterior of the parameters that the equations of motion identify from the target alone.
void infer_regression(const Plan& plan, const Node& node, h5::File& file);

/// The posterior under the likelihood of the observation noise, from that of another method or the
/// prior. Goes on from a checkpoint.
void infer_refined(const Plan& plan, const Node& node, ArtefactWriter& writer);

/// The check of training of the network that has learned least: one that isn't converged, or has
/// the largest gap. Networks of a pool's likelihood count where they aren't converged: their power,
/// by held-out simulations, makes up for a gap, and where it is 0 they say nothing. `notes`: of
/// networks.
inference::TrainingCheck check_training_curves(const PosteriorNotes& notes,
                                               const inference::TrainingConfig& config);

}  // namespace npdr::pipeline
