#include "pipeline/config/study_warnings.h"

#include "pipeline/config/simulator_info.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

std::vector<std::string> warnings_after(const std::vector<std::string>& overrides) {
  const Study study = parse_study(kStudyText, "s.toml", overrides);
  return warnings_of(study, sim::make_simulator(study.simulator)->info());
}

TEST(StudyWarnings, AStudyWithoutFaultHasNone) { EXPECT_EQ(warnings_after({}).size(), 0u); }

TEST(StudyWarnings, NameTheTruthThatThePriorExcludes) {
  const auto given = warnings_after({"prior.pole_mass={ uniform = [0.3, 1.05] }"});
  ASSERT_EQ(given.size(), 1u);
  EXPECT_EQ(given[0],
            "s.toml:6:23: warning: target.truth.pole_mass = 1.1, outside of the prior, [0.3, "
            "1.05]: no posterior can hold it; widen prior.pole_mass");
  const auto nominal = warnings_after({"prior.pole_length={ uniform = [1.1, 1.2] }"});
  ASSERT_EQ(nominal.size(), 1u);
  EXPECT_NE(nominal[0].find("the truth's pole_length, its nominal value = 1, outside"),
            std::string::npos)
      << nominal[0];
}

TEST(StudyWarnings, NameTheReferenceThatThePriorExcludes) {
  const auto found = warnings_after(
      {"reference=[{ name = 'sheet', parameters = { pole_mass = 2.0, damping = 0.1 } }]"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("pole_mass of reference 'sheet' = 2, outside of the prior, [0.3, 1.7]"),
            std::string::npos)
      << found[0];
}

TEST(StudyWarnings, SegmentsOfAStepLeaveNothingToCompare) {
  const auto found = warnings_after({"simulator.segment_length=1"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(says(found[0], {"--set simulator.segment_length=1: warning: ",
                              "rmse and dtw compare the states before each action"}));
  EXPECT_EQ(warnings_after({"simulator.segment_length=2"}).size(), 0u);
}

TEST(StudyWarnings, ChecksThatNoMethodCanBePutTo) {
  const std::string checks = "diagnose.checks=['sbc', 'ood']";
  EXPECT_EQ(warnings_after({checks}).size(), 0u);
  const auto found =
      warnings_after({checks, "method=[{ name = 'A', algorithm = 'abc_rejection' }]"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(says(found[0], {"--set diagnose.checks=['sbc', 'ood']: warning",
                              "without sbc: there is no network"}));
}

TEST(StudyWarnings, NoiseIsSmallerThanMotion) {
  const auto found = warnings_after({"observation_noise.scale=1.5"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(says(found[0], {"--set observation_noise.scale=1.5: warning: ",
                              "leaves little to infer from", "such as 0.02"}));
  EXPECT_EQ(warnings_after({"observation_noise.scale=0.5"}).size(), 0u);
}

TEST(StudyWarnings, ARecordingHasNoise) {
  const TempFolder folder;
  folder.file("r.h5", "");
  const std::string text = edited(kStudyText, "truth = { pole_mass = 1.1 }",
                                  "recording = '" + (folder / "r.h5").string() + "'");
  const auto found = [&](const std::vector<std::string>& overrides) {
    const Study study = parse_study(text, "s.toml", overrides);
    return warnings_of(study, sim::make_simulator(study.simulator)->info());
  };
  ASSERT_EQ(found({}).size(), 1u);
  EXPECT_NE(found({})[0].find("warning: observation_noise has no scale"), std::string::npos);
  EXPECT_EQ(found({"observation_noise.scale=0.01"}).size(), 0u);
  EXPECT_EQ(found({"observation_noise.scale=0.0"}).size(), 0u) << "it is meant";
  EXPECT_EQ(found({"observation_noise.std={ theta = 0.1, theta_dot = 0.0 }"}).size(), 0u);
  const auto in_part = found({"observation_noise.std={ theta = 0.1 }"});
  ASSERT_EQ(in_part.size(), 1u);
  EXPECT_NE(in_part[0].find("observation_noise.std leaves theta_dot without noise"),
            std::string::npos)
      << in_part[0];
  // A program may draw its own.
  const auto of_program = [&](const std::vector<std::string>& overrides) {
    const Study study = parse_study(
        "[study]\nname = 's'\n[target]\nrecording = '" + (folder / "r.h5").string() +
            "'\n[simulator]\nworker = 'cat'\nstates = ['a']\n[prior]\nk = { uniform = [0, 1] "
            "}\n[[method]]\nname = 'A'\n",
        "s.toml", overrides);
    return warnings_of(study, simulator_info(study));
  };
  ASSERT_EQ(of_program({}).size(), 1u);
  EXPECT_TRUE(says(of_program({})[0], {"s.toml: warning: observation_noise has no scale",
                                       "unless the simulator draws it"}));
  EXPECT_EQ(of_program({"observation_noise.scale_prior=[0.1, 1.0]"}).size(), 0u);
}

}  // namespace
}  // namespace npdr::pipeline
