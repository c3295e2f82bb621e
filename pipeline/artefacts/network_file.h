/// The networks of a posterior artefact, by layers that have names: the groups `network_1`, ...;
/// and checkpoints, what their interrupted training goes on from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inference/diagnostics/out_of_distribution.h"
#include "inference/network_posterior.h"
#include "inference/training/trainer.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_json.h"
#include "pipeline/store/hostile_json.h"

namespace npdr::pipeline {

/// Settings as an attribute: JSON, as in the resolved study.
template <class Config>
void describe_json(Layout f, const std::string& name, Config& config, const char* meaning) {
  std::string text = to_json(config).dump();
  f.attribute(name, text, meaning);
  if (f.reads()) {
    const std::string where = f.where() + ": attribute '" + name + "'";
    config = from_json<Config>(parse_json(text, where), where);
  }
}

/// What the network is, as attributes of the file: role, settings, what its structure depends on.
void describe_architecture(Layout f, inference::NetworkParts& parts);

/// Group of network m = 0, 1, ...: "network_1", ...
std::string group_of_network(Index m);
/// Those of a file that `f` reads; of all that there may be when it doesn't.
std::vector<Index> networks_there(const Layout& f);

/// The layers of the networks of such an architecture, prior and transform: their parameters.
/// Throws InputError for a file that doesn't hold as many weights as its architecture has.
void describe_layers(Layout f, inference::NetworkParts& parts);

/// The group `transform`. Throws InputError for parts that don't go together.
void describe(Layout f, inference::FeatureTransform& transform);

/// Usual x of a posterior's simulations: the group `usual`, missing of fewer than
/// inference::kFewestSimulations.
void describe(Layout f, std::optional<inference::UsualFeatures>& usual);
/// Throws InputError.
std::optional<inference::UsualFeatures> read_usual_features(const ArtefactFile& posterior);

/// States that interrupted trainings go on from.
struct TrainingCheckpoint {
  std::vector<inference::TrainingState> trainings;  ///< one a network; empty: not begun
  Cost cost;                                        ///< of the work that led here
};
void describe(Layout f, TrainingCheckpoint& checkpoint);

}  // namespace npdr::pipeline
