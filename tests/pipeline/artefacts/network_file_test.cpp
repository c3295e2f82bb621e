#include "pipeline/artefacts/network_file.h"

#include <gtest/gtest.h>

#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

inference::TrainingState state_of(Index num_weights, Index epochs) {
  inference::TrainingState state;
  state.parameters = VectorF::LinSpaced(num_weights, 0.0F, 1.0F);
  state.average = state.best_parameters = 2.0F * state.parameters;
  state.adam.first_moment = state.adam.second_moment = 3.0F * state.parameters;
  state.adam.num_steps = 7 * epochs;
  state.epoch = epochs;
  state.training_loss = state.validation_loss =
      std::vector<double>(static_cast<std::size_t>(epochs), 1.5);
  return state;
}

// Those of a pool: networks of a posterior, one of which hasn't begun, and of a likelihood.
TEST(CheckpointFile, NetworksNeedNotBeOfOneSize) {
  const TempFolder folder;
  const Identity identity{.key_document = {{"stage", "infer"}}, .inputs = {}, .study = {}};
  const std::filesystem::path path = folder.path() / "pool.checkpoint.h5";
  kCheckpointSchema.write(path, identity, {{state_of(5, 3), {}, state_of(11, 2)}, {}});
  const TrainingCheckpoint checkpoint = kCheckpointSchema.read({path, identity.key()});
  ASSERT_EQ(checkpoint.trainings.size(), 3u);
  for (const auto& [m, expected] : {std::pair{0u, state_of(5, 3)}, {2u, state_of(11, 2)}}) {
    const inference::TrainingState& state = checkpoint.trainings[m];
    EXPECT_EQ(state.epoch, expected.epoch);
    EXPECT_EQ(state.parameters, expected.parameters);
    EXPECT_EQ(state.best_parameters, expected.best_parameters);
    EXPECT_EQ(state.adam.second_moment, expected.adam.second_moment);
    EXPECT_EQ(state.validation_loss, expected.validation_loss);
  }
  EXPECT_EQ(checkpoint.trainings[1].epoch, 0);
}

}  // namespace
}  // namespace npdr::pipeline
