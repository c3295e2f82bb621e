#include "pipeline/import/rollout_length.h"

#include "core/error.h"
#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

Target target_of(const std::vector<Index>& lengths) {
  Target target{0.1, {{"x", "m"}}, {{"u", "V"}}, {}, "test"};
  for (const Index length : lengths) {
    const std::string name = target.rollouts.empty() ? "a" : "b";
    target.rollouts.push_back(
        {name, Vector::LinSpaced(length + 1, 0.0, 1.0), Vector::Ones(length)});
  }
  return target;
}

TEST(RolloutLength, IsCutIntoPiecesOfTheShortestOrANumber) {
  Target target = target_of({5, 3});
  EXPECT_EQ(
      texts_of(cut_rollouts(target, 0)),
      std::vector<std::string>{
          "cut into rollouts of 3 steps: 1 of a (2 steps dropped), 1 of b (0 steps dropped)"});
  target.check("x");
  EXPECT_EQ(target.num_steps(), 3);
  EXPECT_EQ(target.rollouts[0].name, "a");
  EXPECT_DOUBLE_EQ(target.rollouts[0].states(3, 0), 0.6) << "the first steps are kept";

  Target long_one = target_of({5, 3});
  cut_rollouts(long_one, 2);
  long_one.check("x");
  ASSERT_EQ(long_one.num_rollouts(), 3);
  EXPECT_EQ(long_one.rollouts[1].name, "a.2");
  EXPECT_EQ(long_one.rollouts[2].name, "b");
  const RowMatrix second = Vector{{0.4, 0.6, 0.8}};
  EXPECT_TRUE(long_one.rollouts[1].states.isApprox(second)) << "it begins where the first one ends";
}

TEST(RolloutLength, IsLeftAsItIsWhereAllAreEqual) {
  Target equal = target_of({3, 3});
  EXPECT_TRUE(cut_rollouts(equal, {}).empty());
}

}  // namespace
}  // namespace npdr::pipeline
