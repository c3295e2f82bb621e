/// Mistakes in studies of the users' simulators: each is named at its place.
#include "pipeline/artefacts/recording.h"
#include "tests/cli/own_simulator.h"
#include "tests/device_recordings.h"

namespace npdr::pipeline {
namespace {

TEST_F(OwnSimulators, RecordedActionsThatTheyArentGivenAreAWarning) {
  write_recording(furuta_recording(2), folder_ / "recorded.h5");
  folder_.file("sim.py", "");
  ASSERT_EQ(npdr({"new", "mine", "--recording", "recorded.h5", "--worker", "cat sim.py"}).status,
            0);
  const auto warnings = [&](const std::string& setting) {
    return npdr({"validate", "mine.toml", "--set", setting}).err;
  };
  EXPECT_EQ(warnings("target.held_out=0"), "");
  EXPECT_TRUE(has(warnings("simulator.actions=[]"), "isn't given the recorded action voltage"));
}

// Once, though everything that asks the worker fails; and told as what the study calls it.
TEST_F(OwnSimulators, AParameterThatTheStudyDoesntHaveIsToldOnce) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  write_recording(furuta_recording(2), folder_ / "recorded.h5");
  folder_.file("sim.py", R"py(
import npdr_worker
npdr_worker.serve(lambda theta, first_state, actions, dt, rng: theta["mass"])
)py");
  ASSERT_EQ(
      npdr({"new", "mine", "--recording", "recorded.h5", "--worker", python + " sim.py"}).status,
      0);
  const Outcome outcome = npdr({"run", "mine.toml", "--set", "target.held_out=0"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(has(outcome.err, {"KeyError: \"the study has no parameter 'mass'; it has a\"",
                                "failed (exit status 1), as above:"}));
  const std::size_t first = outcome.err.find("Traceback");
  EXPECT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("Traceback", first + 1), std::string::npos) << outcome.err;
}

// The likelihood of a refinement is that of motion which follows from theta.
TEST_F(OwnSimulators, ARefinementRefusesMotionThatIsDrawn) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  copy_example("spring");
  folder_.file("sim.py", R"py(
import npdr_worker
def simulate(theta, first_state, actions, dt, rng):
    return [[theta["stiffness"] + 0.1 * rng.normal(), 1.0] for _ in actions]
npdr_worker.serve(simulate)
)py");
  const std::string study = text_of(folder_ / "worker.toml");
  folder_.file("refine.toml", study.substr(0, study.find("[[method]]")) +
                                  "[[method]]\nname = \"Refined\"\nalgorithm = \"refine\"\n");
  const Outcome outcome =
      npdr({"run", "refine.toml", "--set", "simulator.worker='" + python + " sim.py'"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(has(outcome.err, "simulated twice with the same parameters, channel 'q' differs"));
}

TEST_F(OwnSimulators, RowsInAnotherOrderStopTheStudy) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  copy_example("spring");
  folder_.file("sorted.py", R"py(
import numpy as np
import npdr_worker
def simulate(theta, first_state, actions, dt, seeds):
    slope = np.sort(theta["stiffness"])
    return slope[:, None, None] * np.arange(len(actions))[None, :, None] * np.ones(2)
npdr_worker.serve(simulate, batch=True)
)py");
  const Outcome outcome = npdr({"run", "worker.toml", "--until", "simulate", "--set",
                                "simulator.worker='" + python + " sorted.py'"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(has(outcome.err, "rows in another order than those of theta"));
}

TEST_F(OwnSimulators, ALibraryThatLoopsIsToldWithARowAfterItsTimeLimit) {
  copy_example("spring");
  const std::string rows = "for (int64_t i = 0; i < batch->num_rows; ++i) {";
  std::string source = text_of(folder_ / "spring.c");
  const std::size_t begin = source.find(rows);
  ASSERT_NE(begin, std::string::npos);
  source.insert(begin + rows.size(), "\n    while (batch->theta[4 * i + 1] > 30.0) usleep(1000);");
  folder_.file("spring.c", "#include <unistd.h>\n" + source);
  compile_spring(folder_.path());
  const Outcome outcome = npdr({"run", "library.toml", "--set", "simulator.time_limit=0.5"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(has(outcome.err, {"spring.so: replay() hasn't returned after 0.5 s for",
                                "the first of which has mass = 1, stiffness = ",
                                "raise simulator.time_limit", "the status NPDR_DIVERGED"}));
  const Outcome refused = npdr({"validate", "library.toml", "--set", "simulator.retries=2"});
  EXPECT_TRUE(has(refused.err, "it belongs to simulator.command and simulator.worker"));
  folder_.file("built_in.toml", "[simulator]\nname = \"pendulum\"\ntime_limit = 1.0\n");
  const Outcome built_in = npdr({"validate", "built_in.toml"});
  EXPECT_TRUE(
      has(built_in.err, "simulator.time_limit must be left out: it belongs to simulators of"));
}

TEST_F(OwnSimulators, AGoalThatALibraryHasNoChannelForIsNamed) {
  copy_example("spring");
  compile_spring(folder_.path());
  const std::string text = text_of(folder_ / "library.toml");
  folder_.file("goal.toml", text + "\n[simulator.goal]\nplace = { qq = 0.0 }\nradius = 0.1\n");
  const Outcome outcome = npdr({"validate", "goal.toml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(has(outcome.err, "unknown state channel 'qq' (did you mean 'q'?)"));
}

}  // namespace
}  // namespace npdr::pipeline
