#include "pipeline/artefacts/refinement_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using inference::ImportanceSampler;

const inference::ImportanceConfig kConfig = {.level_size = 1000, .min_ess = 300.0};
const StreamId kId = {1, "refinement", 1, 0, 0};

// Tells the likelihood of blocks; stops after `most`.
void advance(ImportanceSampler& sampler, int most = 1'000'000) {
  for (int block = 0; block < most && !sampler.is_done(); ++block) {
    const RowMatrix u = sampler.next(300);
    sampler.tell(-50.0 * (u.rowwise().sum().array() - 1.0).square());
  }
}

class RefinementFile : public ::testing::Test {
 protected:
  TempFolder folder_;
};

TEST_F(RefinementFile, CheckpointsGoOnToTheSameBits) {
  ImportanceSampler whole(kConfig, 2, {}, kId), stopped(kConfig, 2, {}, kId);
  advance(whole);
  advance(stopped, 7);  // levels with and without a flow, and one in the middle
  const std::filesystem::path path = folder_.path() / "checkpoint.h5";
  Identity identity;
  identity.key_document = {{"what", "test"}};
  write_refinement(path, identity, {stopped.state(), 3, {}, {1.5, 2.5}});
  const RefinementCheckpoint read = read_refinement({path, identity.key()});
  EXPECT_EQ(read.num_failed, 3);
  EXPECT_GE(read.cost.core_seconds, 2.5);
  ImportanceSampler resumed(kConfig, 2, {}, kId, read.state);
  advance(resumed);
  EXPECT_EQ(resumed.sample().u, whole.sample().u);
  EXPECT_EQ(resumed.sample().weights, whole.sample().weights);
}

TEST_F(RefinementFile, NoCheckpointIsAnEmptyOne) {
  EXPECT_TRUE(read_refinement({folder_.path() / "none.h5", "key"}).state.levels.empty());
}

}  // namespace
}  // namespace npdr::pipeline
