/// How the stage 'infer' makes a posterior, by the family of the algorithm. Each fills the artefact
/// of `node`; the caller finishes it. Throws as run_infer() does. Private to pipeline/stages.
#pragma once

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

}  // namespace npdr::pipeline
