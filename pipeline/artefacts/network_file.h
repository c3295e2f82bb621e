/// The networks of a posterior artefact, by layers that have names: the groups `network_1`, ...
#pragma once

#include <string>
#include <vector>

#include "inference/network_posterior.h"
#include "pipeline/artefacts/layout.h"

namespace npdr::pipeline {

/// What the network is, as attributes of the file: role, settings, what its structure depends on.
void describe_architecture(Layout f, inference::NetworkParts& parts);

/// Group of network m = 0, 1, ...: "network_1", ...
std::string group_of_network(Index m);
/// Those of a file that `f` reads; of all that there may be when it doesn't.
std::vector<Index> networks_there(const Layout& f);

/// The layers of the networks of such an architecture, prior and transform: their parameters.
/// Throws InputError for a file that doesn't hold as many weights as its architecture has.
void describe_layers(Layout f, inference::NetworkParts& parts);

}  // namespace npdr::pipeline
