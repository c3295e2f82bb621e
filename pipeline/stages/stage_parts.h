/// Methods of the stage 'infer', the check of training, and checkpoints. Private to
/// pipeline/stages.
///
/// Each infer_ function makes the posterior of a family of algorithms and fills the artefact of
/// `node`; the caller finishes the artefact. Throws as stages do.
#pragma once

#include <filesystem>
#include <utility>

#include "core/error.h"
#include "core/stop_request.h"
#include "inference/diagnostics/training_check.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/plan/plan.h"
#include "pipeline/process/progress.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// The posterior after one round of approximate Bayesian computation.
void infer_abc(const Plan& plan, const Node& node, h5::File& file);

/// The posterior of the parameters that the equations of motion identify from the target alone.
void infer_regression(const Plan& plan, const Node& node, h5::File& file);

/// The posterior by the curvature of a robust least-squares fit, from simulations that it asks for.
void infer_least_squares(const Plan& plan, const Node& node, h5::File& file);

/// The posterior under the likelihood of the observation noise, from that of another method or the
/// prior. Goes on from a checkpoint.
void infer_refined(const Plan& plan, const Node& node, ArtefactWriter& writer);

/// The check of training of the network that has learned least: one that isn't converged, or has
/// the largest gap. Networks of a pool's likelihood count where they aren't converged: their power,
/// by held-out simulations, makes up for a gap, and where it is 0 they say nothing. `notes`: of
/// networks.
inference::TrainingCheck check_training_curves(const PosteriorNotes& notes,
                                               const inference::TrainingConfig& config);

/// The checkpoint of a node, which holds a State with its cost.
template <class State>
class Checkpoints {
 public:
  /// Keeps references. The work begins now.
  Checkpoints(const Plan& plan, const Node& node, const Artefact<State>& artefact)
      : node_(node),
        artefact_(artefact),
        file_{plan.work.checkpoint(name_of(node.stage), node.key), node.key} {}

  const ArtefactFile& file() const { return file_; }
  /// What an earlier run left; a new state where there is none. Throws InputError for damage.
  State read() const { return artefact_.read_if_there(file_).value_or(State()); }

  /// Whether the last one is a minute old.
  bool is_due() const { return seconds_since(saved_) > 60.0; }
  /// Writes one; `state`: with the cost of all work but that of this process.
  void save(State state) {
    saved_ = Clock::now();
    state.cost += cost_of_seconds(seconds_since(start_));
    artefact_.write(file_.path, node_.identity, std::move(state));
  }
  /// Ends the work. Throws Checkpointed.
  [[noreturn]] void stop() const {
    throw Checkpointed(node_.label() + ": stopped on request, checkpoint written");
  }

 private:
  const Node& node_;
  const Artefact<State>& artefact_;
  ArtefactFile file_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point saved_ = start_;
};

}  // namespace npdr::pipeline
