#include "inference/abc/abc.h"
#include "inference/algorithms/posterior_estimation.h"
#include "pipeline/external/dataset_rows.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/stages/particle_file.h"
#include "pipeline/stages/posterior_file.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

RowMatrix propose_from(const Plan& plan, const Node& posterior, Index n, const StreamId& id,
                       const MethodConfig& method) {
  const inference::Algorithm algorithm = method.algorithm.kind;
  if (inference::traits_of(algorithm).family == inference::AlgorithmFamily::network) {
    const auto network = read_network_posterior(posterior.path, posterior.key);
    return inference::propose(estimation_config(method), *network, n, id);
  }
  const h5::File file = open_artefact(posterior.path, kPosteriorSchema, posterior.key);
  return inference::propose(algorithm, inference::Prior(plan.study.prior), read_population(file), n,
                            id);
}

}  // namespace

void run_propose(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kProposalSchema, node.identity);
  const Use& use = node.uses.front();
  const Index n = num_rows(plan, node);
  const auto posteriors = plan.inputs(node, Stage::infer);
  RowMatrix theta;
  if (plan.study.external.dataset) {
    const DatasetFile dataset = open_dataset(plan.study);
    theta = dataset.theta(dataset_rows(use.seed, dataset.num_rows(), n));
  } else if (posteriors.empty()) {
    // Calibration, round 0, has draws of its own.
    theta = inference::sample_prior(inference::Prior(plan.study.prior), n, use.seed,
                                    use.stream_round());
  } else {
    theta =
        propose_from(plan, *posteriors.front(), n, {use.seed, "proposal", use.stream_round(), 0, 0},
                     plan.study.method(use.method));
  }
  write_theta(writer.file(), plan, theta);
  writer.finish();
}

}  // namespace npdr::pipeline
