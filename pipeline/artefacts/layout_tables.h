/// The layouts of all artefacts (layout.h) as the tables of docs/file-formats.md.
#pragma once

#include <string>
#include <vector>

#include "pipeline/artefacts/layout.h"

namespace npdr::pipeline {

/// Each describes what an artefact holds besides what every artefact says about itself, and is
/// defined beside its layout.
void list_observation(Layout f);
void list_target(Layout f);
void list_proposal(Layout f);
void list_simulation(Layout f);
void list_posterior(Layout f);
void list_flow(Layout f);
void list_mixture(Layout f);
void list_ratio_network(Layout f);
void list_particles(Layout f);
void list_certificate(Layout f);
void list_training_checkpoint(Layout f);
void list_refinement_checkpoint(Layout f);
void list_asked_rows(Layout f);
void list_simulated_rows(Layout f);
void list_evaluation(Layout f);
void list_diagnosis(Layout f);
void list_diagnosis_checkpoint(Layout f);
void list_policy(Layout f);
void list_policy_checkpoint(Layout f);
void list_policy_test(Layout f);
void list_baseline(Layout f);

std::vector<std::string> layout_names();

/// Markdown. Throws InputError for an unknown name.
std::string layout_table(const std::string& name);

}  // namespace npdr::pipeline
