#include "tests/message_of.h"
#include "tests/pipeline/findings/findings_fixture.h"

namespace npdr::pipeline {
namespace {

TEST_F(Verdicts, SeedsThatContradictEachOtherAreSaid) {
  data_.seeds = {1, 2};
  data_.runs.push_back(data_.runs.front());
  data_.runs.back().use.seed = 2;
  EXPECT_EQ(finding_of(Check::contraction).what, "");
  data_.runs.back().evaluation.theta = samples_around(1.1, 0.02);  // five deviations off
  EXPECT_TRUE(says(finding_of(Check::contraction).what,
                   {"seeds contradict each other about pole_mass (3.5), pole_length (3.5)",
                    "believe all of them together", "try more simulations"}));
  plan_.study.policy.search.kind = inference::PolicyOptimizerKind::power;
  plan_.study.methods.front().num_iterations = 2;
  EXPECT_EQ(finding_of(Check::contraction).what, "") << "each has an observation of its own";
}

class Contradictions : public Verdicts {
 protected:
  void add_method(const std::string& name, double mean) {
    data_.methods.push_back(name);
    data_.runs.push_back(data_.runs.front());
    data_.runs.back().use.method = name;
    data_.runs.back().evaluation.theta = samples_around(mean, 0.02);
  }
  std::string reason() const { return finding_of(Check::contraction).what; }
};

TEST_F(Contradictions, OfEachMethodAreSaidByItsFarthestParameter) {
  plan_.study.methods.push_back(plan_.study.methods.front());
  plan_.study.methods.back().name = "Third";
  add_method("NPDR (MoG)", 1.1);
  add_method("Third", 1.1);
  data_.runs.back().evaluation.theta.col(1) = samples_around(1.2, 0.02).col(1);
  EXPECT_TRUE(says(
      reason(), {"contradicts NPDR (MoG) about pole_mass (3.5), Third about pole_length (7.1)"}));
}

// Seeds that lie apart widen what they say together, but not what any of them is sure of.
TEST_F(Contradictions, OfMethodsAreSaidWhereSeedsContradictEachOther) {
  data_.seeds = {1, 2};
  add_method("NPDR (MoG)", 1.07);
  add_method("NPDR (MoG)", 1.15);
  data_.methods.pop_back();
  data_.runs.back().use.seed = 2;
  EXPECT_TRUE(says(reason(), {"contradicts NPDR (MoG) about pole_mass (3.9)"}));
}

TEST_F(Contradictions, ArentThoseOfMethodsThatInferOtherParameters) {
  add_method("NPDR (MoG)", 1.1);
  data_.runs.back().evaluation.theta.col(0).setConstant(0.5);
  EXPECT_EQ(reason(), "") << "taken as known";
}

// Samples of a network that extrapolates may all lie on a bound.
TEST_F(Contradictions, ArentThoseOfSamplesWithoutWidth) {
  add_method("NPDR (MoG)", 1.0);
  data_.runs.back().evaluation.theta.col(0).setConstant(0.3);
  EXPECT_EQ(reason(), "");
}

TEST_F(Contradictions, ArentThoseOfOuterLoops) {
  add_method("NPDR (MoG)", 1.1);
  plan_.study.policy.search.kind = inference::PolicyOptimizerKind::power;
  for (MethodConfig& method : plan_.study.methods) method.num_iterations = 2;
  EXPECT_EQ(reason(), "");
}

}  // namespace
}  // namespace npdr::pipeline
