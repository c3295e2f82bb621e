/// The layouts of all artefacts (layout.h) as the tables of docs/file-formats.md.
#pragma once

#include <string>
#include <vector>

#include "pipeline/artefacts/layout.h"

namespace npdr::pipeline {

/// Each describes artefacts, or parts of them, that aren't read and written as a whole (schemas.h),
/// and is defined beside its layout.
void list_observation(Layout f);
void list_target(Layout f);
void list_simulation(Layout f);
void list_posterior(Layout f);
void list_flow(Layout f);
void list_mixture(Layout f);
void list_ratio_network(Layout f);
void list_particles(Layout f);
void list_certificate(Layout f);

std::vector<std::string> layout_names();

/// Markdown. Throws InputError for an unknown name.
std::string layout_table(const std::string& name);

}  // namespace npdr::pipeline
