#include "inference/algorithms/posterior_estimation.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/stages/posterior_file.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {

void run_propose(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kProposalSchema, node.identity);
  const Use& use = node.uses.front();
  const Index n = num_rows(plan, node);
  const auto posteriors = plan.inputs(node, Stage::infer);
  RowMatrix theta;
  if (posteriors.empty()) {
    theta = inference::sample_prior(inference::Prior(plan.study.prior), n, use.seed);
  } else {
    const auto posterior = read_posterior(*posteriors.front());
    theta = inference::propose(estimation_config(plan.study.method(use.method)), *posterior, n,
                               {use.seed, "proposal", static_cast<std::uint64_t>(use.round), 0, 0});
  }
  write_theta(writer.file(), plan, theta);
  writer.finish();
}

}  // namespace npdr::pipeline
