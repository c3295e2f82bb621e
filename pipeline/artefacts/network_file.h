/// The network of a posterior artefact, by layers that have names: the group `network`.
#pragma once

#include "inference/network_posterior.h"
#include "pipeline/artefacts/layout.h"

namespace npdr::pipeline {

/// What the network is, as attributes of the file: role, settings, what its structure depends on.
void describe_architecture(Layout f, inference::NetworkParts& parts);

/// The layers of the network of such an architecture, prior and transform: its parameters. Throws
/// InputError for a file that doesn't hold as many weights as its architecture has.
void describe_layers(Layout f, inference::NetworkParts& parts);

}  // namespace npdr::pipeline
