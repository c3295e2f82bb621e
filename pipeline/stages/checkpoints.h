/// Checkpoints: what an interrupted stage goes on from. Private to pipeline/stages.
#pragma once

#include <filesystem>
#include <utility>

#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/plan/plan.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {

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
