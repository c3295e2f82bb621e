#include "pipeline/report/texts.h"

#include "tests/pipeline/findings/findings_fixture.h"

namespace npdr::pipeline {
namespace {

class NextSteps : public Verdicts {
 protected:
  NextSteps() {
    data_.methods.push_back(kOther);
    data_.runs.push_back(data_.runs.front());
    data_.runs.back().use.method = kOther;
    data_.diagnoses.push_back(data_.diagnoses.front());
    data_.diagnoses.back().use.method = kOther;
  }

  void fail(const std::string& method) {
    for (auto& diagnosis : data_.diagnoses) {
      if (diagnosis.use.method == method) diagnosis.result.training->is_converged = false;
    }
  }

  static constexpr const char* kOther = "NPDR (MoG)";
};

TEST_F(NextSteps, SayWhatTheChecksFoundOfEachPosterior) {
  fail(kMethod);
  EXPECT_TRUE(
      has(next_steps(data_),
          "npdr-maf/seed-1/round-1/infer.h5    # NPDR (MAF): 1 of 8 checks FAIL: Training\n"));
  EXPECT_TRUE(
      has(next_steps(data_),
          "npdr-mog/seed-1/round-1/infer.h5    # NPDR (MoG): all 8 checks pass; not checked: "
          "Calibration\n"));
}

TEST_F(NextSteps, GoOnWithThatOfWhichTheFewestFail) {
  EXPECT_TRUE(has(next_steps(data_), "npdr sample runs/small/npdr-maf/seed-1/"))
      << "the first of equal ones";
  fail(kMethod);
  EXPECT_TRUE(has(next_steps(data_), "npdr sample runs/small/npdr-mog/seed-1/"));
}

TEST_F(NextSteps, MendingIsTheFirstWhereChecksFail) {
  EXPECT_FALSE(has(next_steps(data_), "fail: do first"));
  fail(kMethod);
  EXPECT_FALSE(has(next_steps(data_), "fail: do first")) << "the other one passes";
  fail(kOther);
  EXPECT_TRUE(
      has(next_steps(data_), "# Checks of NPDR (MAF) fail: do first what the verdicts say"));
}

TEST_F(NextSteps, DontTakeWhatWasNeverCheckedForGood) {
  plan_.study.diagnose.checks = {Check::training};
  plan_.study.methods.back().algorithm.kind = inference::Algorithm::abc_smc;
  fail(kMethod);
  EXPECT_TRUE(has(next_steps(data_), "infer.h5    # NPDR (MoG)\n"));
  EXPECT_TRUE(has(next_steps(data_), "npdr sample runs/small/npdr-maf/seed-1/"));
}

}  // namespace
}  // namespace npdr::pipeline
