#include "inference/training/trainer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "inference/ensemble.h"

namespace npdr::inference {
namespace {

// Least squares: y_i = a t_i + b with t_i = i / 100, a = 2, b = -1.
class Line : public Objective {
 public:
  Index num_rows() const override { return 400; }
  double loss(const Parameters<float>& p, const Batch& batch,
              Parameters<float>* gradient) override {
    double sum = 0.0;
    if (gradient != nullptr) gradient->setZero();
    for (const std::uint32_t row : batch.rows) {
      rows_seen.insert(row);
      const float t = static_cast<float>(row) / 100.0f;
      const float error = p(0) * t + p(1) - (2.0f * t - 1.0f);
      sum += static_cast<double>(error * error);
      if (gradient == nullptr) continue;
      (*gradient)(0) += 2.0f * error * t / static_cast<float>(batch.rows.size());
      (*gradient)(1) += 2.0f * error / static_cast<float>(batch.rows.size());
    }
    return sum / static_cast<double>(batch.rows.size());
  }
  std::set<std::uint32_t> rows_seen;
};

TrainingConfig config() {
  TrainingConfig c;
  c.learning_rate = 0.05;
  c.max_epochs = 300;
  return c;
}

const StreamId kTrainingId{1, "train", 1, 0, 0};

TrainingState start() {
  TrainingState state;
  state.parameters = Parameters<float>::Zero(2);
  return state;
}

bool go_on(const TrainingState&) { return true; }

TEST(Trainer, FindsTheLeastSquaresLine) {
  Line line;
  TrainingState state = start();
  train(line, config(), kTrainingId, state, go_on);
  EXPECT_NEAR(state.best_parameters(0), 2.0, 1e-2);
  EXPECT_NEAR(state.best_parameters(1), -1.0, 2e-2);
  EXPECT_EQ(line.rows_seen.size(), 400u);
  EXPECT_EQ(state.validation_loss.size(), static_cast<std::size_t>(state.epoch));
}

TEST(Trainer, ContinuesFromACheckpointWithTheSameBits) {
  Line line;
  TrainingState whole = start();
  train(line, config(), kTrainingId, whole, go_on);
  TrainingState parts = start();
  while (!parts.finished(config())) {
    train(line, config(), kTrainingId, parts,
          [](const TrainingState& s) { return s.epoch % 7 != 0; });
  }
  EXPECT_EQ(whole.epoch, parts.epoch);
  EXPECT_EQ(whole.best_parameters, parts.best_parameters);
  EXPECT_EQ(whole.training_loss, parts.training_loss);
}

TEST(Trainer, StopsEarlyAndKeepsTheBestWeights) {
  Line line;
  TrainingState state = start();
  state.parameters << 2.0f, -1.0f;  // already perfect: every step makes it worse
  TrainingConfig c = config();
  c.stop_after_epochs = 5;
  train(line, c, kTrainingId, state, go_on);
  EXPECT_EQ(state.epoch, 5);
  EXPECT_EQ(state.best_parameters(0), 2.0f);
}

// Steps of constant length jump around the minimum of a noisy loss; their average doesn't.
class NoisyTarget : public Objective {
 public:
  Index num_rows() const override { return 1000; }
  double loss(const Parameters<float>& p, const Batch& batch,
              Parameters<float>* gradient) override {
    if (gradient == nullptr) return static_cast<double>(p.squaredNorm());
    Stream stream({1, "noise", 0, batch.number, batch.epoch});
    for (Index i = 0; i < p.size(); ++i) {
      (*gradient)(i) = 2.0f * p(i) + static_cast<float>(stream.normal());
    }
    return 0.0;
  }
};

TEST(Trainer, AveragingBringsNoisyWeightsToTheMinimum) {
  const auto error = [](double average_epochs) {
    NoisyTarget target;
    TrainingState state;
    state.parameters = Parameters<float>::Constant(100, 1.0f);
    TrainingConfig c;
    c.learning_rate = 0.05;
    c.max_epochs = 60;
    c.average_epochs = average_epochs;
    train(target, c, kTrainingId, state, go_on);
    return state.validation_loss.back();
  };
  EXPECT_LT(error(5.0), 0.5 * error(0.0));
}

TEST(Trainer, ReportsATrainingThatDiverged) {
  Line line;
  TrainingState state = start();
  TrainingConfig c = config();
  c.learning_rate = 1e38;
  EXPECT_THROW(train(line, c, kTrainingId, state, go_on), Error);
}

TEST(Trainer, TakesAllRowsWhenTheyAreFewerThanABatch) {
  Line line;
  TrainingState state = start();
  TrainingConfig c = config();
  c.batch_size = 1000;
  c.max_epochs = 3;
  train(line, c, kTrainingId, state, go_on);
  EXPECT_EQ(line.rows_seen.size(), 400u);
}

// Which rows are asked for without a gradient.
class Watcher : public Objective {
 public:
  explicit Watcher(Index rows) : rows_(rows) {}
  Index num_rows() const override { return rows_; }
  double loss(const Parameters<float>&, const Batch& batch, Parameters<float>* gradient) override {
    auto& seen = gradient == nullptr ? validated : trained;
    seen.insert(batch.rows.begin(), batch.rows.end());
    if (gradient != nullptr) gradient->setZero();
    return 0.0;
  }
  std::set<std::uint32_t> trained, validated;

 private:
  Index rows_;
};

TEST(Trainer, NeverValidatesOnRowsThatAnEarlierRoundTrainedOn) {
  Watcher first(1000), second(2000);
  std::uint64_t round = 1;
  for (Watcher* watcher : {&first, &second}) {
    TrainingState state = start();
    TrainingConfig c = config();
    c.max_epochs = 30;
    train(*watcher, c, {1, "train", round++, 0, 0}, state, go_on);
  }
  EXPECT_EQ(first.validated.size(), 100u);
  EXPECT_EQ(second.validated.size(), 200u);
  for (const std::uint32_t row : second.validated) EXPECT_FALSE(first.trained.contains(row)) << row;
  for (const std::uint32_t row : second.validated)
    EXPECT_FALSE(second.trained.contains(row)) << row;
}

// Of those of the first round every third is left, which the second knows by their numbers.
TEST(Trainer, RowsKeepTheirPartWhereOthersAreLeftOut) {
  std::vector<std::uint32_t> left;
  for (std::uint32_t row = 0; row < 2000; row += row < 1000 ? 3 : 1) left.push_back(row);
  Watcher first(1000), second(std::ssize(left));
  TrainingConfig c = config();
  c.max_epochs = 30;
  TrainingState one = start(), two = start();
  train(first, c, kTrainingId, {1, 0}, one, go_on);
  train(second, c, kTrainingId, {1, 0, left}, two, go_on);
  EXPECT_GT(second.validated.size(), 100u);
  for (const std::uint32_t row : second.validated) {
    EXPECT_FALSE(first.trained.contains(left[row])) << left[row];
  }
}

// What one network is judged by, the others train on.
TEST(Trainer, EachNetworkValidatesOnRowsOfItsOwn) {
  std::set<std::uint32_t> all;
  for (Index m = 0; m < 10; ++m) {
    Watcher watcher(1000);
    TrainingState state = start();
    train(watcher, {.max_epochs = 1}, {seed_of_network(1, m), "train", 1, 0, 0}, {1, m}, state,
          go_on);
    EXPECT_EQ(watcher.validated.size(), 100u);
    all.merge(watcher.validated);
  }
  EXPECT_EQ(all.size(), 1000u);
}

TEST(Trainer, RejectsASplitThatLeavesNothingToValidate) {
  Line line;
  TrainingState state = start();
  TrainingConfig c = config();
  c.validation_fraction = 0.001;
  EXPECT_THROW(train(line, c, kTrainingId, state, go_on), InputError);
}

TEST(Adam, ClipsToTheNormAndSkipsABrokenGradient) {
  Parameters<float> gradient(2);
  gradient << 30.0f, 40.0f;
  EXPECT_NEAR(clip_scale(gradient, 5.0), 0.1, 1e-9);
  EXPECT_EQ(clip_scale(gradient, 100.0), 1.0);
  gradient(0) = std::nanf("");
  EXPECT_EQ(clip_scale(gradient, 5.0), 0.0);
}

// Worked by hand: with g = 1 the first step is rate * 1 / (1 + eps) whatever the betas.
TEST(Adam, FirstStepHasTheLengthOfTheLearningRate) {
  Adam adam(1, 0.1);
  Parameters<float> p = Parameters<float>::Constant(1, 3.0f);
  adam.step(Parameters<float>::Constant(1, 1.0f), 1.0, p);
  EXPECT_NEAR(p(0), 2.9, 1e-6);
  adam.step(Parameters<float>::Constant(1, 1.0f), 1.0, p);
  EXPECT_NEAR(p(0), 2.8, 1e-5);
}

}  // namespace
}  // namespace npdr::inference
