/// Mistakes in studies of the users' simulators: each is named at its place.
#include "pipeline/artefacts/recording.h"
#include "tests/analysis/markup_check.h"
#include "tests/cli/own_simulator.h"
#include "tests/device_recordings.h"

namespace npdr::pipeline {
namespace {

TEST_F(OwnSimulators, RecordedActionsThatTheyArentGivenAreAWarning) {
  write_recording(furuta_recording(2), folder_ / "recorded.h5");
  folder_.file("sim.py", "");
  npdr(0, {"new", "mine", "--recording", "recorded.h5", "--worker", "cat sim.py"});
  const auto warnings = [&](const std::string& setting) {
    return npdr({"validate", "mine.toml", "--set", setting}).err;
  };
  EXPECT_EQ(warnings("target.held_out=0"), "");
  EXPECT_TRUE(has(warnings("simulator.actions=[]"), "isn't given the recorded action voltage"));
}

// Once, though everything that asks the worker fails; and told as what the study calls it.
TEST_F(PythonWorkers, AParameterThatTheStudyDoesntHaveIsToldOnce) {
  write_recording(furuta_recording(2), folder_ / "recorded.h5");
  folder_.file("sim.py", R"py(
import npdr_worker
npdr_worker.serve(lambda theta, first_state, actions, dt, rng: theta["mass"])
)py");
  npdr(0, {"new", "mine", "--recording", "recorded.h5", "--worker", python_ + " sim.py"});
  const Outcome outcome = npdr(1, {"run", "mine.toml", "--set", "target.held_out=0"});
  EXPECT_TRUE(has(outcome.err, {"KeyError: \"the study has no parameter 'mass'; it has a\"",
                                "failed (exit status 1), as above:"}));
  EXPECT_EQ(analysis::count_of(outcome.err, "Traceback"), 1) << outcome.err;
}

// The likelihood of a refinement is that of motion which follows from theta.
TEST_F(PythonWorkers, ARefinementRefusesMotionThatIsDrawn) {
  folder_.file("sim.py", R"py(
import npdr_worker
def simulate(theta, first_state, actions, dt, rng):
    return [[theta["stiffness"] + 0.1 * rng.normal(), 1.0] for _ in actions]
npdr_worker.serve(simulate)
)py");
  const std::string study = text_of(folder_ / "worker.toml");
  folder_.file("refine.toml", study.substr(0, study.find("[[method]]")) +
                                  "[[method]]\nname = \"Refined\"\nalgorithm = \"refine\"\n");
  EXPECT_TRUE(has(npdr(2, {"run", "refine.toml", "--set", setting("sim.py")}).err,
                  "simulated twice with the same parameters, channel 'q' differs"));
}

TEST_F(OwnSimulators, ALibraryThatLoopsIsToldWithARowAfterItsTimeLimit) {
  copy_example("spring");
  const std::string rows = "for (int64_t i = 0; i < batch->num_rows; ++i) {";
  folder_.file("spring.c",
               "#include <unistd.h>\n" +
                   edited(text_of(folder_ / "spring.c"), rows,
                          rows + "\n    while (batch->theta[4 * i + 1] > 30.0) usleep(1000);"));
  compile_spring(folder_.path());
  EXPECT_TRUE(has(npdr(2, {"run", "library.toml", "--set", "simulator.time_limit=0.5"}).err,
                  {"spring.so: replay() hasn't returned after 0.5 s for",
                   "the first of which has mass = 1, stiffness = ", "raise simulator.time_limit",
                   "the status NPDR_DIVERGED"}));
  folder_.file("built_in.toml", "[simulator]\nname = \"pendulum\"\ntime_limit = 1.0\n");
  EXPECT_TRUE(has(npdr({"validate", "built_in.toml"}).err,
                  "simulator.time_limit must be left out: it belongs to simulators of"));
}

}  // namespace
}  // namespace npdr::pipeline
