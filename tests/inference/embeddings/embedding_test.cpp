#include "inference/embeddings/embedding.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace npdr::inference {
namespace {

// Two rollouts of six steps with two channels; state t of rollout h is (t + 10 h, t^2).
Target ramp() {
  Target target;
  target.dt = 0.1;
  target.state_channels = {{"position", "m"}, {"energy", "J"}};
  target.action_channels = {{"force", "N"}};
  for (int h = 0; h < 2; ++h) {
    Rollout rollout{"r", RowMatrix(7, 2), RowMatrix(6, 1)};
    for (Index t = 0; t < 7; ++t) {
      rollout.states(t, 0) = static_cast<double>(t) + 10.0 * h;
      rollout.states(t, 1) = static_cast<double>(t * t);
    }
    for (Index t = 0; t < 6; ++t) rollout.actions(t, 0) = static_cast<double>(t);
    target.rollouts.push_back(rollout);
  }
  return target;
}

std::vector<float> embed(const EmbeddingConfig& config, Index store_every = 1) {
  const Target target = ramp();
  const auto embedding = make_embedding(config, target, store_every);
  const VectorF x = observed_features(*embedding, target, store_every);
  EXPECT_EQ(x.size(), embedding->num_features());
  return {x.begin(), x.end()};
}

EmbeddingConfig config(EmbeddingKind kind, Index downsample = 1,
                       const std::vector<std::string>& channels = {}) {
  EmbeddingConfig c;
  c.kind = kind;
  c.downsample = downsample;
  c.channels = channels;
  return c;
}

TEST(Embedding, AllStepsKeepsTheStatesAfterEachStep) {
  const auto x = embed(config(EmbeddingKind::all_steps, 1, {"position"}));
  EXPECT_EQ(x, (std::vector<float>{1, 2, 3, 4, 5, 6, 11, 12, 13, 14, 15, 16}));
}

TEST(Embedding, DownSamplingKeepsEveryKthStateHoweverTheSeriesIsStored) {
  const EmbeddingConfig every_second = config(EmbeddingKind::linear, 2, {"energy"});
  EXPECT_EQ(embed(every_second), (std::vector<float>{4, 16, 36, 4, 16, 36}));
  EXPECT_EQ(embed(every_second, 2), embed(every_second, 1));
}

TEST(Embedding, DeltaAndLastSteps) {
  EXPECT_EQ(embed(config(EmbeddingKind::delta_steps, 2)),
            (std::vector<float>{2, 12, 2, 20, 2, 12, 2, 20}));
  EXPECT_EQ(embed(config(EmbeddingKind::last_step)), (std::vector<float>{6, 36, 16, 36}));
}

// Worked by hand, second channel, no down-sampling: ds = 3, 5, 7, 9, 11 with a = 1, 2, 3, 4, 5.
TEST(Embedding, BayesSimGivesProductsMeanAndVarianceOfTheDifferences) {
  const auto x = embed(config(EmbeddingKind::bayessim, 1, {"energy"}));
  ASSERT_EQ(x.size(), 6u);
  EXPECT_FLOAT_EQ(x[0], 1 * 3 + 2 * 5 + 3 * 7 + 4 * 9 + 5 * 11);
  EXPECT_FLOAT_EQ(x[1], 7);
  EXPECT_FLOAT_EQ(x[2], 8);
}

// With every second state: ds = 16 - 4, 36 - 16; the actions between are (2 + 3) / 2, (4 + 5) / 2.
TEST(Embedding, BayesSimAveragesTheActionsBetweenKeptStates) {
  const auto x = embed(config(EmbeddingKind::bayessim, 2, {"energy"}));
  EXPECT_FLOAT_EQ(x[0], 2.5f * 12 + 4.5f * 20);
}

TEST(Embedding, RejectsUnknownChannelsAndTooMuchDownSampling) {
  EXPECT_THROW(embed(config(EmbeddingKind::all_steps, 1, {"postion"})), InputError);
  EXPECT_THROW(embed(config(EmbeddingKind::all_steps, 4)), InputError);
  EXPECT_THROW(embed(config(EmbeddingKind::all_steps, 3), 2), InputError);
}

}  // namespace
}  // namespace npdr::inference
