// The verdict on what refinements leave of their recording.
#include "pipeline/report/verdicts.h"
#include "tests/message_of.h"
#include "tests/pipeline/report/verdict_fixture.h"

namespace npdr::pipeline {
namespace {

class ResidualVerdicts : public Verdicts {
 protected:
  ResidualVerdicts() {
    plan_.study.methods.front().algorithm.kind = inference::Algorithm::refine;
    plan_.study.diagnose.checks = {Check::residuals};
  }

  // Of 1000 errors of each channel; the last one's say the same `memory` times in a row.
  Verdict verdict_at(double memory, double size, double power) {
    PosteriorNotes& notes = data_.runs.front().notes;
    notes.certificate = {.power = power, .wanted_power = power};
    const Index channels = data_.target.num_states();
    notes.residuals = {1000, Vector::Ones(channels), Vector::Ones(channels)};
    notes.residuals->memory(channels - 1) = memory;
    notes.residuals->size(channels - 1) = size;
    plan_.study.target.truth.reset();
    plan_.study.target.recording = "recording.h5";
    return verdict_of(Check::residuals);
  }

  std::string last_channel() const { return data_.target.state_channels.back().label; }
};

TEST_F(ResidualVerdicts, IndependentErrorsPass) {
  EXPECT_EQ(verdict_at(1.2, 1.0, 1.0).text, "passes, variance 1.2 times the noise's");
  EXPECT_TRUE(says(verdict_at(1.2, 1.0, 1.0).reason,
                   {"it takes recorded first states for exact", "refine.infer_first_states"}));
  EXPECT_EQ(verdict_at(1.2, 1.0, 0.5).reason, "") << "a power that makes up for much";
  plan_.study.methods.front().refine.infer_first_states = true;
  EXPECT_EQ(verdict_at(1.2, 1.0, 1.0).reason, "");
}

TEST_F(ResidualVerdicts, ErrorsThatFollowEachOtherFail) {
  const Verdict found = verdict_at(16.0, 1.0, 1.0);
  EXPECT_EQ(found.judgment, Judgment::fails);
  EXPECT_EQ(found.text, "they AREN'T like the noise, variance 16 times the noise's");
  EXPECT_TRUE(
      says(found.reason,
           {"what its likeliest parameters leave of channel '" + last_channel() + "' is not noise",
            ": 16 errors in a row say the same; its posterior is at least about 4 "
            "times too narrow, and where the simulator lacks something",
            "refine.infer_first_states = true"}));
}

// Of 1000 errors of two channels 1.67 may be chance.
TEST_F(ResidualVerdicts, ErrorsThatFollowEachOtherALittleAreSaid) {
  const Verdict found = verdict_at(1.8, 1.0, 1.0);
  EXPECT_EQ(found.judgment, Judgment::passes);
  EXPECT_TRUE(says(found.reason, {"what its likeliest",
                                  ": 1.8 errors in a row say the same; its "
                                  "posterior is at least about 1.3 times too narrow"}));
  EXPECT_TRUE(says(verdict_at(1.5, 1.0, 1.0).reason, {"it takes recorded first states"}));
}

TEST_F(ResidualVerdicts, APowerMakesUpForThem) {
  EXPECT_EQ(verdict_at(16.0, 1.0, 0.1).judgment, Judgment::passes);
}

TEST_F(ResidualVerdicts, ErrorsThatAreLargerThanTheNoiseFail) {
  const Verdict found = verdict_at(1.0, 9.0, 1.0);
  EXPECT_EQ(found.judgment, Judgment::fails);
  EXPECT_TRUE(says(found.reason, {"what its likeliest", ": they are 3 times as large;"}));
}

TEST_F(ResidualVerdicts, AdviseWhatIsNotDoneYet) {
  plan_.study.methods.front().refine.infer_first_states = true;
  plan_.study.methods.front().refine.sampling.cross_validate = true;
  plan_.study.observation_noise.correlation_prior = {0.5, 1.0};
  const std::string reason = verdict_at(16.0, 1.0, 1.0).reason;
  for (const char* done : {"infer_first_states", "cross_validate", "correlation_prior"}) {
    EXPECT_EQ(reason.find(done), std::string::npos) << done;
  }
}

TEST_F(ResidualVerdicts, NoNumberFails) {
  EXPECT_EQ(verdict_at(std::nan(""), 1.0, 1.0).judgment, Judgment::fails);
}

TEST_F(ResidualVerdicts, DontAdviseWhatIsRefused) {
  (void)verdict_at(16.0, 1.0, 1.0);
  plan_.study.target.recording.reset();
  EXPECT_EQ(verdict_of(Check::residuals).reason.find("infer_first_states"), std::string::npos);
}

TEST_F(ResidualVerdicts, CantTellWithoutThem) {
  (void)verdict_at(1.0, 1.0, 1.0);
  data_.runs.front().notes.residuals.reset();
  EXPECT_EQ(verdict_of(Check::residuals).judgment, Judgment::unknown);
}

TEST_F(ResidualVerdicts, MeanNothingToNetworks) {
  plan_.study.methods.front().algorithm.kind = inference::Algorithm::npe_c;
  EXPECT_TRUE(verdicts_of(data_, plan_.study.methods.front().name).empty());
}

}  // namespace
}  // namespace npdr::pipeline
