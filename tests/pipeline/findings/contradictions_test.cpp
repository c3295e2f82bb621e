#include "tests/message_of.h"
#include "tests/pipeline/findings/findings_fixture.h"

namespace npdr::pipeline {
namespace {

// Others are in tests/golden/report.txt.
class Contradictions : public Verdicts {
 protected:
  EvaluatedRun& add_run_of(const std::string& method, double mean) {
    data_.runs.push_back(data_.runs.front());
    data_.runs.back().use.method = method;
    data_.runs.back().evaluation.theta = samples_around(mean, 0.02);
    return data_.runs.back();
  }
  RowMatrix& add_method(const std::string& name, double mean) {
    data_.methods.push_back(name);
    return add_run_of(name, mean).evaluation.theta;
  }
  void iterate() {
    plan_.study.policy.search.kind = inference::PolicyOptimizerKind::power;
    for (MethodConfig& method : plan_.study.methods) method.num_iterations = 2;
  }
  std::string reason() const { return finding_of(Check::contraction).what; }
};

TEST_F(Contradictions, OfSeedsAreNoneWhereEachHasAnObservationOfItsOwn) {
  data_.seeds = {1, 2};
  add_run_of(kMethod, 1.1).use.seed = 2;  // five deviations off
  EXPECT_NE(reason(), "");
  iterate();
  EXPECT_EQ(reason(), "");
}

TEST_F(Contradictions, OfEachMethodAreSaidByItsFarthestParameter) {
  plan_.study.methods.push_back(plan_.study.methods.front());
  plan_.study.methods.back().name = "Third";
  add_method("NPDR (MoG)", 1.1);
  add_method("Third", 1.1).col(1) = samples_around(1.2, 0.02).col(1);
  EXPECT_TRUE(says(
      reason(), {"contradicts NPDR (MoG) about pole_mass (3.5), Third about pole_length (7.1)"}));
}

// Seeds that lie apart widen what they say together, but not what any of them is sure of.
TEST_F(Contradictions, OfMethodsAreSaidWhereSeedsContradictEachOther) {
  data_.seeds = {1, 2};
  add_method("NPDR (MoG)", 1.07);
  add_run_of("NPDR (MoG)", 1.15).use.seed = 2;
  EXPECT_TRUE(says(reason(), {"contradicts NPDR (MoG) about pole_mass (3.9)"}));
}

TEST_F(Contradictions, ArentThoseOfWhatIsKnownOfSamplesWithoutWidthOrOfLoops) {
  RowMatrix& other = add_method("NPDR (MoG)", 1.1);
  other.col(0).setConstant(0.5);
  EXPECT_EQ(reason(), "") << "taken as known";
  // Samples of a network that extrapolates may all lie on a bound.
  other = samples_around(1.0, 0.02);
  other.col(0).setConstant(0.3);
  EXPECT_EQ(reason(), "");
  other = samples_around(1.1, 0.02);
  iterate();
  EXPECT_EQ(reason(), "");
}

}  // namespace
}  // namespace npdr::pipeline
