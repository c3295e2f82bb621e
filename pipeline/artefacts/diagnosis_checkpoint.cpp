#include "pipeline/artefacts/diagnosis_checkpoint.h"

#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/artefacts/described_artefact.h"

namespace npdr::pipeline {
namespace {

using inference::CalibrationRanks;

bool are_within(const CalibrationRanks& ranks) {
  const auto counts = [&](const auto& of_all) {
    return (of_all.array() >= 0).all() && (of_all.array() <= ranks.num_samples).all();
  };
  return counts(ranks.parameter) && counts(ranks.density) && counts(ranks.distance);
}

}  // namespace

void describe(Layout f, DiagnosisCheckpoint& checkpoint) {
  CalibrationRanks& ranks = checkpoint.ranks;
  if (f.writes()) ranks.resize(ranks.num_done, ranks.theta.cols());
  f.attribute("num_samples", ranks.num_samples, "of each posterior");
  f.attribute("num_done", ranks.num_done, "simulations whose truths are ranked");
  const Dims dims = {kRow, kParameter};
  f("parameter", ranks.parameter, dims, "how many samples are smaller than the truth");
  f("density", ranks.density, {kRow}, "how many are more likely");
  f("distance", ranks.distance, {kRow}, "how many are nearer to a random draw of the prior");
  f("theta", ranks.theta, dims, "one sample of each posterior", kFinite);
  f("log_prob", ranks.log_prob, {kRow}, "density of the truths [nats]; may be NaN");
}
template struct Artefact<DiagnosisCheckpoint>;

DiagnosisCheckpoint read_diagnosis_checkpoint(const ArtefactFile& artefact, const RowMatrix& theta,
                                              Index num_samples) {
  const auto found = kDiagnosisCheckpointSchema.read_if_there(artefact);
  if (!found) return {{.num_samples = num_samples}, {}};
  const CalibrationRanks& ranks = found->ranks;
  if (ranks.num_samples == num_samples && ranks.theta.cols() == theta.cols() &&
      ranks.num_done == ranks.theta.rows() && ranks.num_done <= theta.rows() && are_within(ranks)) {
    return *found;
  }
  throw InputError(fmt::format("{}: not of this diagnosis, or damaged; remove this file",
                               artefact.path.string()));
}

}  // namespace npdr::pipeline
