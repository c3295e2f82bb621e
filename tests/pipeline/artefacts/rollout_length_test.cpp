#include "pipeline/artefacts/rollout_length.h"

#include "core/error.h"
#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

const std::vector<std::string> kFiles = {"a.csv", "b.csv"};

Target target_of(const std::vector<Index>& lengths) {
  Target target{0.1, {{"x", "m"}}, {{"u", "V"}}, {}, "test"};
  for (const Index length : lengths) {
    const std::string name = kFiles[target.rollouts.size()].substr(0, 1);
    target.rollouts.push_back(
        {name, Vector::LinSpaced(length + 1, 0.0, 1.0), Vector::Ones(length)});
  }
  return target;
}

TEST(RolloutLength, IsCutToTheShortestOrANumber) {
  Target target = target_of({5, 3});
  EXPECT_EQ(cut_rollouts(target, 0, kFiles),
            std::vector<std::string>{"cut to 3 steps; steps that are dropped: a 2, b 0"});
  target.check("x");
  EXPECT_EQ(target.num_steps(), 3);
  EXPECT_DOUBLE_EQ(target.rollouts[0].states(3, 0), 0.6) << "the first steps are kept";
  cut_rollouts(target, 2, kFiles);
  EXPECT_EQ(target.num_steps(), 2);
}

TEST(RolloutLength, MayDifferOnlyWithAnOption) {
  Target target = target_of({5, 3});
  EXPECT_TRUE(says(message_of<InputError>([&] { cut_rollouts(target, {}, kFiles); }),
                   {"b.csv: has 4 rows, the first file has 6", "cut the longer ones",
                    "--length shortest or --length STEPS"}));
  EXPECT_TRUE(says(message_of<InputError>([&] { cut_rollouts(target, 4, kFiles); }),
                   {"--length 4: b.csv has 3 steps", "must have at least as many"}));
  Target equal = target_of({3, 3});
  EXPECT_TRUE(cut_rollouts(equal, {}, kFiles).empty());
}

}  // namespace
}  // namespace npdr::pipeline
