// Verdicts on what posteriors' samples predict.
#include "pipeline/findings/findings.h"

#include "core/random.h"
#include "tests/message_of.h"
#include "tests/pipeline/findings/findings_fixture.h"

namespace npdr::pipeline {
namespace {

// A noise that is inferred takes up what the simulator lacks, and every check passes.
TEST_F(Verdicts, AFloorFarAboveTheScatterOfARecordingIsSaid) {
  plan_.study.target.recording = "recording.h5";
  Stream stream({5, "verdicts_test", 0, 0, 0});
  auto& states = data_.target.rollouts.front().states;
  for (double& value : states.reshaped()) value += 0.004 * stream.normal();
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.02}}}};
  EXPECT_EQ(finding_of(Check::fit).what, "");
  data_.baseline.points = {{"floor", Vector(), {{"rmse", 0.04}}}};
  EXPECT_LE(finding_of(Check::fit).severity, Severity::note);
  EXPECT_TRUE(says(finding_of(Check::fit).what,
                   {"no parameters explain the recording better than the floor's 0.04", "10 times",
                    "what neighboring samples scatter by", "the simulator lacks something"}));
  plan_.study.observation_noise.correlation_prior = {0.5, 1.0};
  EXPECT_EQ(finding_of(Check::fit).what, "") << "it may be noise";
}

// Samples of the exact posterior of a linear model with white noise of N = 2 D + 10 values: the
// rate that the documents tell is below 1e-6; 2000 trials of a fixed seed.
TEST_F(Verdicts, TheErrorOfAnExactPosteriorIsNeverFarAboveTheFloor) {
  constexpr Index dimension = 2, values = 14, num_samples = 200;
  for (std::uint64_t trial = 0; trial < 2000; ++trial) {
    Stream stream({1, "fit_check", 0, trial, 0});
    const auto chi_square = [&](Index degrees) {
      double sum = 0.0;
      for (Index i = 0; i < degrees; ++i) sum += std::pow(stream.normal(), 2);
      return sum;
    };
    const double residual = chi_square(values - dimension);
    Vector rmse(num_samples);
    const auto of = [](double sum) { return 0.1 * std::sqrt(sum / values); };
    for (double& value : rmse) value = of(residual + chi_square(dimension));
    data_.baseline.prior->metrics["rmse"].setZero();
    data_.baseline.points = {{"floor", Vector(), {{"rmse", of(residual)}}}};
    data_.runs.front().evaluation.metrics["rmse"] = rmse;
    ASSERT_LE(finding_of(Check::fit).severity, Severity::note) << trial;
  }
}

}  // namespace
}  // namespace npdr::pipeline
