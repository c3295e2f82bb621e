/// Simulators of the user's that give rollouts: the examples of experiments/external.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "pipeline/artefacts/recording.h"
#include "pipeline/store/h5.h"
#include "tests/cli/own_simulator.h"
#include "tests/device_recordings.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

TEST_F(OwnSimulators, ALibraryFindsTheTruth) {
  copy_example("spring");
  compile_spring(folder_.path());
  const Outcome listed = npdr({"list", "simulators", "library.toml"});
  EXPECT_TRUE(has(listed.out, "stiffness")) << listed.err;
  EXPECT_TRUE(has(listed.out, "N s/m"));
  EXPECT_TRUE(has(npdr(0, small("library.toml")).out, {"RMSE", "DTW dist.", "nominal", "truth"}));
  EXPECT_TRUE(fs::exists(runs("spring-library") / "figures"));
  // The deviation of the posterior is around 1 N/m: five of them are more than any seed misses.
  const RowMatrix theta = first_round("spring-library", "evaluate").read_matrix<double>("theta");
  EXPECT_NEAR(theta.col(0).mean(), 24.0, 5.0);

  const fs::path simulated = runs("spring-library") / "npe/seed-1/round-1/simulate.h5";
  EXPECT_TRUE(says(npdr(2, {"verify", simulated.string()}).err,
                   {"npdr verify: ", "the library \"" + (folder_ / "spring.so").string() + "\"",
                    "add --run-command"}));
  npdr(0, {"verify", simulated.string(), "--run-command"});
  EXPECT_FALSE(has(npdr(joined(small("library.toml"), {"--dry-run"})).out, "missing"));
}

TEST_F(OwnSimulators, ALibraryIsVerifiedFromAnyFolder) {
  copy_example("spring");
  compile_spring(folder_.path());
  fs::create_directory(folder_ / "sub");
  for (const char* file : {"library.toml", "spring.so"}) {
    fs::rename(folder_ / file, folder_ / "sub" / file);
  }
  npdr(0,
       {"run", "sub/library.toml", "--until", "simulate", "--set", "method.num_simulations=100"});
  const fs::path simulated = runs("spring-library") / "npe/seed-1/round-1/simulate.h5";
  const std::vector<std::string> verify = {"npdr", "verify", simulated.string(), "--run-command"};
  for (const fs::path& folder : {folder_.path(), folder_ / "sub", fs::path("/")}) {
    with_status(0, run(folder, verify));
  }
  fs::rename(folder_ / "sub", folder_ / "moved");
  EXPECT_EQ(run(folder_ / "moved", verify).status, 0) << "in the current folder";
  EXPECT_EQ(run(folder_.path(), verify).status, 2);
}

TEST_F(PythonWorkers, AWorkerGivesWhatTheLibraryGives) {
  compile_spring(folder_.path());
  npdr(0, words(setting("spring.py")));
  npdr(0, {"run", "library.toml", "--until", "simulate", "--set", "method.num_simulations=70"});
  const auto mine = trajectories("spring-worker"), theirs = trajectories("spring-library");
  ASSERT_EQ(mine.size(), theirs.size());
  // C may contract products and sums, numpy doesn't.
  for (std::size_t i = 0; i < mine.size(); ++i) ASSERT_NEAR(mine[i], theirs[i], 1e-4) << i;
}

// Bits of a worker's simulations don't depend on threads or shards, and survive being killed.
TEST_F(PythonWorkers, AWorkersBitsDependOnNothingButTheStudy) {
  folder_.file("noisy.py", R"py(
import npdr_worker
def simulate(theta, first_state, actions, dt, rng):
    return [[theta["stiffness"] + rng.normal(), rng.normal()] for _ in actions]
npdr_worker.serve(simulate)
)py");
  const auto words_for = [&](const std::string& work, const std::string& shard_size) {
    return words(setting("noisy.py"),
                 {"--work", work, "--set", "method.num_rounds=1", "--set", "target.num_rollouts=2",
                  "--set", "simulate.shard_size=" + shard_size});
  };
  const auto bits = [&](const std::string& work, int num_threads, const std::string& shard_size) {
    const OmpThreads threads(num_threads);
    npdr(0, words_for(work, shard_size));
    return trajectories("spring-worker", work);
  };
  const auto one = bits("one", 1, "1000");
  EXPECT_EQ(one, bits("shards", 2, "7"));

  const Program killed(folder_.path(), joined({"npdr"}, words_for("killed", "7")));
  EXPECT_TRUE(comes_true([&] {
    return std::ranges::any_of(files_ending(folder_ / "killed/.cache/simulate", ".h5"),
                               [](const auto& name) { return has(name, "/rows-"); });
  }));
  killed.send(SIGKILL);
  killed.wait();
  EXPECT_EQ(one, bits("killed", 2, "7"));
}

// Segments and rollouts of a row have random numbers of their own, in batches and one by one.
TEST_F(PythonWorkers, NoiseOfAWorkerDoesNotRepeatItself) {
  folder_.file("batch.py", R"py(
import numpy as np
import npdr_worker
def simulate(theta, first_state, actions, dt, seeds):
    return np.array([np.random.default_rng(s).normal(size=(len(actions), 2)) for s in seeds])
npdr_worker.serve(simulate, batch=True)
)py");
  folder_.file("single.py", R"py(
import numpy as np
import npdr_worker
def simulate(theta, first_state, actions, dt, rng):
    assert isinstance(rng, np.random.Generator)
    return rng.normal(size=(len(actions), 2))
npdr_worker.serve(simulate)
)py");
  folder_.file("segments.py", R"py(
import numpy as np
import npdr_worker
def simulate(theta, first_state, actions, dt, seeds):
    assert first_state.shape == (len(seeds), 2) and actions.shape[0] == len(theta["mass"])
    return np.array([np.random.default_rng(s).normal(size=(actions.shape[1], 2)) for s in seeds])
npdr_worker.serve(simulate, batch="segments")
)py");
  for (const std::string program : {"batch", "single", "segments"}) {
    npdr(0, words(setting(program + ".py"),
                  {"--work", program, "--set", "simulator.segment_length=125"}));
    auto x = trajectories("spring-worker", program);
    const std::size_t count = x.size();
    std::ranges::sort(x);
    x.erase(std::unique(x.begin(), x.end()), x.end());
    // About 1 in 1000 of 105,000 floats near 0 meets another by chance.
    EXPECT_GT(static_cast<double>(x.size()), 0.99 * static_cast<double>(count)) << program;
  }
  // Segments at once have the seeds that they have one by one.
  EXPECT_EQ(trajectories("spring-worker", "batch"), trajectories("spring-worker", "segments"));
}

// Modules that mustn't be asked for an attribute, or that have no file, are none of them.
TEST_F(PythonWorkers, ImportsThatTheStudyDoesNotNameAreTold) {
  const std::string program = R"py(
import sys, types
import npdr_worker
from constants import SLOPE
class Lazy(types.ModuleType):
    def __getattribute__(self, name):
        raise ImportError("an optional package")
sys.modules["lazy"] = Lazy("lazy")
sys.modules["compiled"] = types.ModuleType("compiled")
sys.modules["compiled"].__file__ = "_compiled.py"
def simulate(theta, first_state, actions, dt, rng):
    return [[SLOPE * theta["stiffness"] + rng.normal(), 0.0] for _ in actions]
npdr_worker.serve(simulate)
)py";
  for (const std::string folder : {"", "model/"}) {
    std::filesystem::create_directories(folder_ / folder);
    folder_.file(folder + "constants.py", "SLOPE = 1.0\n");
    folder_.file(folder + "sim.py", program);
  }
  const auto said = [&](const std::string& worker, const std::string& files) {
    return npdr(0,
                words("simulator.worker='" + worker + "'", {"--set", "simulator.files=" + files}))
        .err;
  };
  const std::string here = python_ + " sim.py", below = "cd model && " + here;
  const std::string of_here = said(here, "[]"), of_below = said(below, "[]");
  EXPECT_TRUE(has(of_here,
                  "the worker imports files that the study doesn't name: when they are edited, "
                  "nothing is simulated again; add simulator.files = ['constants.py']"));
  EXPECT_FALSE(has(said(here, "['constants.py']"), "the worker imports"));
  const std::string both = "['model/constants.py', 'model/sim.py']";
  EXPECT_TRUE(has(of_below, "simulator.files = " + both));
  EXPECT_FALSE(has(said(below, both), "the worker imports"));
}

// A command that writes states: x = stiffness + t in each row.
TEST_F(OwnSimulators, ACommandGivesRollouts) {
  copy_example("spring");
  folder_.file("sim.sh", R"sh(
[ "$NPDR_DT" = 0.02 ] || exit 1
steps=$(awk -F, 'NR > 1 { n += $1 } END { print n }' "$NPDR_SEGMENTS")
[ "$(wc -l < "$NPDR_ACTIONS")" = $((steps + 1)) ] || exit 1
awk -F, -v steps=$steps 'NR == 1 { for (i = 1; i <= NF; ++i) c[$i] = i; next }
  { for (t = 1; t <= steps; ++t) printf "%.17g,%.17g\n", $c["stiffness"] + t, 0 }' "$1" > "$2"
)sh");
  folder_.file("command.toml", edited(text_of(folder_ / "worker.toml"),
                                      "worker = \"python3 spring.py\"", "command = \"sh sim.sh\""));
  npdr(0, {"run", "command.toml", "--until", "simulate", "--set", "method.num_simulations=70",
           "--set", "method.num_rounds=1"});
  const auto x = trajectories("spring-worker");
  const RowMatrix theta = first_round("spring-worker", "simulate").read_matrix<double>("theta");
  ASSERT_EQ(x.size(), 70u * 3u * 250u * 2u);
  for (std::size_t i = 0; i < 70; ++i) {
    EXPECT_FLOAT_EQ(x[i * 1500], static_cast<float>(theta(static_cast<Index>(i), 0) + 1.0));
    EXPECT_FLOAT_EQ(x[i * 1500 + 1498],
                    static_cast<float>(theta(static_cast<Index>(i), 0) + 750.0));
  }
}

// A built-in simulator, too, may be asked what it does where a device has been.
TEST_F(OwnSimulators, ATruthMayBeginLikeARecording) {
  const Target recorded = furuta_recording(3);
  write_recording(recorded, folder_ / "recorded.h5");
  folder_.file("truth.toml",
               furuta_study("truth")
                   .only("target", {"truth = { pole_mass = 0.02 }", "inputs = \"recorded.h5\""})
                   .method("NPE", {"num_simulations = 100"}));
  npdr(0, {"run", "truth.toml", "--until", "target"});
  const Target made = read_recording(runs("truth") / "target.h5");
  ASSERT_EQ(made.num_rollouts(), 3);
  for (std::size_t h = 0; h < 3; ++h) {
    EXPECT_EQ(made.rollouts[h].actions.cast<float>(), recorded.rollouts[h].actions.cast<float>());
    EXPECT_TRUE(made.rollouts[h].states.row(0).isApprox(recorded.rollouts[h].states.row(0), 1e-6));
    EXPECT_FALSE(made.rollouts[h].states.row(9).isApprox(recorded.rollouts[h].states.row(9), 1e-9));
  }
}

// The cart-pole is recorded by a program of its own, and found again.
TEST_F(OwnSimulators, AModelOfMujocoExplainsARecording) {
  const std::string python = python_with("mujoco");
  if (python.empty() || !fs::exists(NPDR_BINARY_DIR "/lib/npdr_mujoco.so")) {
    GTEST_SKIP() << "no MuJoCo";
  }
  copy_example("cartpole");
  ASSERT_EQ(shell(python + " make_recording.py").status, 0);
  npdr(0, {"import", "rollout-0.csv", "rollout-1.csv", "--states",
           "x [m],theta [rad],x_dot [m/s],theta_dot [rad/s]", "--actions", "force [1]", "-o",
           "recording.h5"});
  EXPECT_TRUE(has(npdr(0, joined(small("study.toml"), {"--set", "target.num_rollouts=1", "--set",
                                                       "method.embedding.principal_components=20"}))
                      .out,
                  {"floor", "held out"}));
}

}  // namespace
}  // namespace npdr::pipeline
