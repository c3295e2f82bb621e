#include "pipeline/artefacts/diagnosis_checkpoint.h"

#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {
namespace {

using inference::CalibrationRanks;

void describe(Layout f, CalibrationRanks& ranks) {
  f.attribute("num_samples", ranks.num_samples, "of each posterior");
  f.attribute("num_done", ranks.num_done, "simulations whose truths are ranked");
  const Dims dims = {kRow, kParameter};
  f("parameter", ranks.parameter, dims, "how many samples are smaller than the truth");
  f("density", ranks.density, {kRow}, "how many are more likely");
  f("distance", ranks.distance, {kRow}, "how many are nearer to a random draw of the prior");
  f("theta", ranks.theta, dims, "one sample of each posterior", kFinite);
  f("log_prob", ranks.log_prob, {kRow}, "density of the truths [nats]; may be NaN");
}

bool are_within(const CalibrationRanks& ranks) {
  const auto counts = [&](const auto& of_all) {
    return (of_all.array() >= 0).all() && (of_all.array() <= ranks.num_samples).all();
  };
  return counts(ranks.parameter) && counts(ranks.density) && counts(ranks.distance);
}

}  // namespace

void write_diagnosis_checkpoint(const std::filesystem::path& path, const Identity& identity,
                                DiagnosisCheckpoint checkpoint) {
  ArtefactWriter writer(path, kDiagnosisCheckpointSchema, identity);
  writer.add_cost(checkpoint.cost);
  CalibrationRanks& ranks = checkpoint.ranks;
  ranks.resize(ranks.num_done, ranks.theta.cols());
  describe(Layout::writer(writer.file()), ranks);
  writer.finish();
}

DiagnosisCheckpoint read_diagnosis_checkpoint(const ArtefactFile& artefact, const RowMatrix& theta,
                                              Index num_samples) {
  DiagnosisCheckpoint found{{.num_samples = num_samples}, {}};
  const auto file = open_artefact_if_there(artefact, kDiagnosisCheckpointSchema);
  if (!file) return found;
  CalibrationRanks& ranks = found.ranks;
  describe(Layout::reader(*file), ranks);
  if (ranks.num_samples != num_samples || ranks.theta.cols() != theta.cols() ||
      ranks.num_done != ranks.theta.rows() || ranks.num_done > theta.rows() || !are_within(ranks)) {
    throw InputError(
        fmt::format("{}: not of this diagnosis, or damaged; remove this file", file->where()));
  }
  found.cost = provenance_of(*file).cost;
  return found;
}

void list_diagnosis_checkpoint(Layout f) {
  CalibrationRanks ranks;
  describe(f, ranks);
}

}  // namespace npdr::pipeline
