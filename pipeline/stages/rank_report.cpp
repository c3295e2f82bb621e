#include "pipeline/stages/rank_report.h"

#include "core/error.h"
#include "core/stop_request.h"

namespace npdr::pipeline {

RankReport::RankReport(const Plan& plan, const Node& node, Index num_simulations,
                       const DiagnosisCheckpoint& earlier)
    : plan_(plan),
      node_(node),
      progress_(node.label(), num_simulations, earlier.ranks.num_done),
      earlier_(earlier.cost) {}

void RankReport::operator()(const inference::CalibrationRanks& ranks) {
  const auto now = Clock::now();
  const bool is_stopping = stop_requested();
  if (is_stopping || seconds_between(saved_, now) > kSecondsBetweenCheckpoints) {
    saved_ = now;
    DiagnosisCheckpoint written{ranks, earlier_};
    written.cost += cost_of_seconds(seconds_between(start_, now));
    kDiagnosisCheckpointSchema.write(checkpoint(plan_, node_).path, node_.identity,
                                     std::move(written));
  }
  // Saved before it is shown: who looks at the progress may be gone.
  progress_.update(ranks.num_done);
  if (is_stopping) throw Checkpointed(node_.label() + ": stopped on request, checkpoint written");
}

ArtefactFile RankReport::checkpoint(const Plan& plan, const Node& node) {
  return {plan.work.checkpoint("diagnose", node.key), node.key};
}

}  // namespace npdr::pipeline
