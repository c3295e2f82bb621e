#include "inference/abc/abc.h"
#include "inference/algorithms/posterior_estimation.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

RowMatrix propose_from(const Plan& plan, const Node& posterior, Index n, const StreamId& id,
                       const MethodConfig& method) {
  const inference::Algorithm algorithm = method.algorithm.kind;
  if (inference::traits_of(algorithm).family == inference::AlgorithmFamily::network) {
    const auto network = read_network_posterior(posterior);
    return inference::propose(estimation_config(method), *network, n, id);
  }
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  return inference::propose(algorithm, inference::Prior(plan.study.prior), read_population(file), n,
                            id);
}

}  // namespace

void run_propose(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kProposalSchema, node.identity);
  const Use& use = node.uses.front();
  const Index n = num_rows(plan, node);
  const Node* posterior = plan.find_input(node, "posterior");
  RowMatrix theta;
  if (auto given = plan.source->theta(use.seed, n)) {
    theta = std::move(*given);
  } else if (posterior == nullptr) {
    // Calibration, round 0, has draws of its own.
    theta = inference::sample_prior(inference::Prior(plan.study.prior), n, use.seed,
                                    use.stream_round());
  } else {
    theta = propose_from(plan, *posterior, n, {use.seed, "proposal", use.stream_round(), 0, 0},
                         plan.study.method(use.method));
  }
  kProposalSchema.write(writer.file(), {std::move(theta), plan.study.prior});
  writer.finish();
}

}  // namespace npdr::pipeline
