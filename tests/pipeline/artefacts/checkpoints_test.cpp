#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using inference::CalibrationRanks;

class DiagnosisCheckpoints : public FolderTest {
 protected:
  // Three of five simulations are ranked.
  static CalibrationRanks three_ranks() {
    CalibrationRanks ranks{.num_samples = 50, .num_done = 3};
    ranks.parameter = RowMatrixX<std::int64_t>::Constant(5, 2, 7);
    ranks.density = VectorX<std::int64_t>::Constant(5, 50);
    ranks.distance = VectorX<std::int64_t>::Constant(5, 0);
    ranks.theta = RowMatrix::Constant(5, 2, 0.5);
    ranks.log_prob = Vector::Constant(5, 1.25);
    return ranks;
  }
  CalibrationRanks written_and_read(const CalibrationRanks& ranks, Index num_simulations = 5,
                                    Index dimension = 2) {
    const std::filesystem::path path = folder_ / "a.checkpoint.h5";
    kDiagnosisCheckpointSchema.write(path, identity_, {ranks, {}});
    const RowMatrix theta = RowMatrix::Zero(num_simulations, dimension);
    return read_diagnosis_checkpoint({path, identity_.key()}, theta, 50).ranks;
  }

  Identity identity_{.key_document = {{"stage", "diagnose"}}, .inputs = {}, .study = {}};
};

TEST_F(DiagnosisCheckpoints, AreRejectedWhereTheyDontFit) {
  EXPECT_THROW(written_and_read(three_ranks(), 2), InputError) << "more than there are";
  EXPECT_THROW(written_and_read(three_ranks(), 5, 3), InputError) << "parameters";
  CalibrationRanks others = three_ranks();
  others.num_samples = 60;
  EXPECT_THROW(written_and_read(others), InputError);
  CalibrationRanks damaged = three_ranks();
  damaged.density(1) = 51;
  EXPECT_THROW(written_and_read(damaged), InputError) << "more than there are samples";
  damaged = three_ranks();
  damaged.parameter(2, 1) = -1;
  EXPECT_THROW(written_and_read(damaged), InputError);
}

using inference::ImportanceSampler;

const inference::ImportanceConfig kConfig = {
    .level_size = 1000, .min_ess = 300.0, .max_simulations = 3000};
const StreamId kId = {1, "refinement", 1, 0, 0};

// Tells the likelihood of blocks; stops after `most`.
void advance(ImportanceSampler& sampler, int most = 1'000'000) {
  for (int block = 0; block < most && !sampler.is_done(); ++block) {
    const RowMatrix u = sampler.next(300);
    sampler.tell(-1e5 * (u.rowwise().sum().array() - 1.0).square());
  }
}

class RefinementFile : public FolderTest {
 protected:
  // A state as it comes back from a checkpoint, with moves of first states.
  RefinementCheckpoint reread(const inference::ImportanceState& state,
                              const std::optional<FirstStateMoves>& moves) const {
    const Identity identity{.key_document = {{"what", "test"}}, .inputs = {}, .study = {}};
    const std::filesystem::path path = folder_ / "a.checkpoint.h5";
    kRefinementCheckpointSchema.write(path, identity, {state, moves, 3, {}, {1.5, 2.5}});
    return kRefinementCheckpointSchema.read({path, identity.key()});
  }
};

TEST_F(RefinementFile, CheckpointsGoOnToTheSameBits) {
  const RowMatrix start = RowMatrix::Random(200, 2);
  ImportanceSampler whole(kConfig, 2, start, kId);
  advance(whole);
  // In the first level, in one with a flow, between levels, among the last.
  for (const int blocks : {1, 4, 6, 7, 10, 13}) {
    ImportanceSampler stopped(kConfig, 2, start, kId);
    advance(stopped, blocks);
    const FirstStateMoves moves{RowMatrix::Random(2, 3), 1, 4000};
    const RefinementCheckpoint read = reread(stopped.state(), moves);
    EXPECT_EQ(read.num_failed, 3);
    EXPECT_EQ(read.moves->first_errors, moves.first_errors);
    EXPECT_EQ(read.moves->count, 1);
    EXPECT_EQ(read.moves->num_draws, 4000);
    EXPECT_GE(read.cost.core_seconds, 2.5);
    ImportanceSampler resumed(kConfig, 2, {}, kId, read.state);
    advance(resumed);
    EXPECT_EQ(resumed.sample().u, whole.sample().u) << blocks;
    EXPECT_EQ(resumed.sample().weights, whole.sample().weights) << blocks;
  }
}

// As in ImportanceClimb.BeginsWhereFlowsAreStuck.
TEST_F(RefinementFile, CheckpointsOfAClimbGoOnToTheSameBits) {
  const inference::ImportanceConfig config = {
      .level_size = 503, .min_ess = 100.0, .max_simulations = 60'000};
  const StreamId id = {3, "refinement", 1, 0, 0};
  const auto step = [](ImportanceSampler& sampler) {
    const RowMatrix u = sampler.next(30);
    sampler.tell(-5e5 * (u.col(1).array() - (30.0 * u.col(0).array()).sin()).square());
  };
  ImportanceSampler whole(config, 2, {}, id);
  // In the middle of a sweep: while walkers climb, and while they fill their level.
  bool climbs = false, fills = false;
  std::vector<ImportanceSampler> resumed;
  while (!whole.is_done()) {
    step(whole);
    const inference::ImportanceState& state = whole.state();
    if (!state.walkers || state.levels.back().log_likelihood.size() == 0) continue;
    const inference::ImportanceLevel& before = state.levels[state.levels.size() - 2];
    const bool is_filling = before.kind == inference::LevelKind::walkers;
    if (is_filling ? before.u.rows() == 0 : state.walkers->num_sweeps < 3) continue;
    if (std::exchange(is_filling ? fills : climbs, true)) continue;
    resumed.emplace_back(config, 2, RowMatrix(), id, reread(state, {}).state);
  }
  EXPECT_EQ(resumed.size(), 2u);
  for (ImportanceSampler& sampler : resumed) {
    while (!sampler.is_done()) step(sampler);
    EXPECT_EQ(sampler.sample().u, whole.sample().u);
    EXPECT_EQ(sampler.sample().weights, whole.sample().weights);
    EXPECT_EQ(sampler.sample().certificate.num_draws, whole.sample().certificate.num_draws);
    EXPECT_EQ(sampler.sample().certificate.missed_share, whole.sample().certificate.missed_share);
  }
}

TEST_F(RefinementFile, RefusesPowersWithoutTheirScores) {
  h5::File file = h5::File::create(folder_ / "scores.h5");
  write_part(file, PowerScores{.power = Vector::Constant(1, 0.1), .noise_factor = {}, .crps = {}});
  EXPECT_THROW(read_part<PowerScores>(file), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
