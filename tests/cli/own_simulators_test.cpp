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

// Whether a shard is complete in a folder of simulations.
bool has_shard(const fs::path& simulations) {
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(simulations, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("rows-") && name.ends_with(".h5")) return true;
  }
  return false;
}

TEST_F(OwnSimulators, ALibraryFindsTheTruth) {
  copy_example("spring");
  compile_spring(folder_.path());
  const Outcome listed = npdr({"list", "simulators", "library.toml"});
  EXPECT_TRUE(has(listed.out, "stiffness")) << listed.err;
  EXPECT_TRUE(has(listed.out, "N s/m"));
  const Outcome outcome = npdr(small("library.toml"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.out, {"RMSE", "DTW dist.", "nominal", "truth"}));
  EXPECT_TRUE(fs::exists(runs("spring-library") / "figures"));
  // The deviation of the posterior is around 1 N/m: five of them are more than any seed misses.
  const RowMatrix theta = samples("spring-library", 1);
  EXPECT_NEAR(theta.col(0).mean(), 24.0, 5.0);

  const fs::path simulated = runs("spring-library") / "npe/seed-1/round-1/simulate.h5";
  const Outcome refused = npdr({"verify", simulated.string()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(says(refused.err,
                   {"npdr verify: ", "the library \"" + (folder_ / "spring.so").string() + "\"",
                    "add --run-command"}));
  const Outcome verified = npdr({"verify", simulated.string(), "--run-command"});
  EXPECT_EQ(verified.status, 0) << verified.err;
  const Outcome again =
      npdr({"run", "library.toml", "--dry-run", "--set", "method.num_simulations=400", "--set",
            "method.num_rounds=1", "--set", "method.training.max_epochs=60", "--set",
            "evaluate.num_samples=200"});
  EXPECT_FALSE(has(again.out, "missing"));
}

TEST_F(OwnSimulators, ALibraryIsVerifiedFromAnyFolder) {
  copy_example("spring");
  compile_spring(folder_.path());
  fs::create_directory(folder_ / "sub");
  for (const char* file : {"library.toml", "spring.so"}) {
    fs::rename(folder_ / file, folder_ / "sub" / file);
  }
  const Outcome outcome = npdr(
      {"run", "sub/library.toml", "--until", "simulate", "--set", "method.num_simulations=100"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const fs::path simulated = runs("spring-library") / "npe/seed-1/round-1/simulate.h5";
  for (const fs::path& folder : {folder_.path(), folder_ / "sub", fs::path("/")}) {
    const Outcome verified = run(folder, {"npdr", "verify", simulated.string(), "--run-command"});
    EXPECT_EQ(verified.status, 0) << folder << verified.err;
  }
  fs::rename(folder_ / "sub", folder_ / "moved");
  const std::vector<std::string> verify = {"npdr", "verify", simulated.string(), "--run-command"};
  EXPECT_EQ(run(folder_ / "moved", verify).status, 0) << "in the current folder";
  EXPECT_EQ(run(folder_.path(), verify).status, 2);
}

TEST_F(OwnSimulators, AWorkerGivesWhatTheLibraryGives) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  copy_example("spring");
  compile_spring(folder_.path());
  const std::string worker = "simulator.worker='" + python + " spring.py'";
  for (const std::string study : {"worker", "library"}) {
    std::vector<std::string> words = {"run",      study + ".toml", "--until",
                                      "simulate", "--set",         "method.num_simulations=100"};
    if (study == "worker") words.insert(words.end(), {"--set", worker});
    const Outcome outcome = npdr(words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  const auto states = [&](const std::string& study) {
    return h5::File::open(runs(study) / "npe/seed-1/round-1/simulate.h5")
        .dataset("trajectories")
        .read<float>();
  };
  const auto mine = states("spring-worker"), theirs = states("spring-library");
  ASSERT_EQ(mine.size(), theirs.size());
  // C may contract products and sums, numpy doesn't.
  for (std::size_t i = 0; i < mine.size(); ++i) ASSERT_NEAR(mine[i], theirs[i], 1e-4) << i;
}

// Bits of a worker's simulations don't depend on threads or shards, and survive being killed.
TEST_F(OwnSimulators, AWorkersBitsDependOnNothingButTheStudy) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  copy_example("spring");
  folder_.file("noisy.py", R"py(
import npdr_worker
def simulate(theta, first_state, actions, dt, rng):
    return [[theta["stiffness"] + rng.normal(), rng.normal()] for _ in actions]
npdr_worker.serve(simulate)
)py");
  const auto bits = [&](const std::string& work, const std::string& threads, Index shard_size) {
    const Outcome outcome = shell(fmt::format(
        "OMP_NUM_THREADS={} '{}/bin/npdr' run worker.toml --work {} --until simulate --set "
        "method.num_simulations=70 --set method.num_rounds=1 --set target.num_rollouts=2 --set "
        "\"simulator.worker='{} noisy.py'\" --set simulate.shard_size={}",
        threads, NPDR_BINARY_DIR, work, python, shard_size));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return h5::File::open(folder_ / work / "spring-worker/npe/seed-1/round-1/simulate.h5")
        .dataset("trajectories")
        .read<float>();
  };
  const auto one = bits("one", "1", 1000);
  EXPECT_EQ(one, bits("two", "2", 1000));
  EXPECT_EQ(one, bits("shards", "2", 7));

  Program killed(folder_.path(),
                 {"npdr", "run", "worker.toml", "--work", "killed", "--until", "simulate", "--set",
                  "method.num_simulations=70", "--set", "method.num_rounds=1", "--set",
                  "target.num_rollouts=2", "--set", "simulator.worker='" + python + " noisy.py'",
                  "--set", "simulate.shard_size=7"});
  EXPECT_TRUE(comes_true([&] { return has_shard(folder_ / "killed/.cache/simulate"); }));
  killed.send(SIGKILL);
  killed.wait();
  EXPECT_EQ(one, bits("killed", "2", 7));
}

// Segments and rollouts of a row have random numbers of their own, in batches and one by one.
TEST_F(OwnSimulators, NoiseOfAWorkerDoesNotRepeatItself) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  copy_example("spring");
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
  for (const std::string program : {"batch", "single"}) {
    const Outcome outcome =
        npdr({"run", "worker.toml", "--until", "simulate", "--work", program, "--set",
              "method.num_simulations=70", "--set", "simulator.segment_length=125", "--set",
              "simulator.worker='" + python + " " + program + ".py'"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    auto x = h5::File::open(folder_ / program / "spring-worker/npe/seed-1/round-1/simulate.h5")
                 .dataset("trajectories")
                 .read<float>();
    const std::size_t count = x.size();
    std::ranges::sort(x);
    x.erase(std::unique(x.begin(), x.end()), x.end());
    // About 1 in 1000 of 105,000 floats near 0 meets another by chance.
    EXPECT_GT(static_cast<double>(x.size()), 0.99 * static_cast<double>(count)) << program;
  }
}

TEST_F(OwnSimulators, EditedFilesThatTheStudyNamesRerun) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  copy_example("spring");
  folder_.file("constants.py", "SLOPE = 1.0\n");
  folder_.file("sim.py", R"py(
import npdr_worker
from constants import SLOPE
def simulate(theta, first_state, actions, dt, rng):
    return [[SLOPE * theta["stiffness"], 0.0] for _ in actions]
npdr_worker.serve(simulate)
)py");
  const auto simulated = [&] {
    const Outcome outcome = npdr(
        {"run", "worker.toml", "--until", "simulate", "--set", "method.num_simulations=70", "--set",
         "simulator.files=['constants.py']", "--set", "simulator.worker='" + python + " sim.py'"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return fs::canonical(runs("spring-worker") / "npe/seed-1/round-1/simulate.h5");
  };
  const fs::path before = simulated();
  EXPECT_EQ(simulated(), before);
  folder_.file("constants.py", "SLOPE = 2.0\n");
  EXPECT_NE(simulated(), before);
}

// Modules that mustn't be asked for an attribute, or that have no file, are none of them.
TEST_F(OwnSimulators, ImportsThatTheStudyDoesNotNameAreTold) {
  const std::string python = python_with("numpy");
  if (python.empty()) GTEST_SKIP() << "no Python with numpy";
  copy_example("spring");
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
    const Outcome outcome =
        npdr({"run", "worker.toml", "--until", "simulate", "--set", "method.num_simulations=70",
              "--set", "simulator.files=" + files, "--set", "simulator.worker='" + worker + "'"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.err;
  };
  const std::string here = python + " sim.py", below = "cd model && " + python + " sim.py";
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
  std::string text = text_of(folder_ / "worker.toml");
  const std::string worker = "worker = \"python3 spring.py\"";
  text.replace(text.find(worker), worker.size(), "command = \"sh sim.sh\"");
  folder_.file("command.toml", text);
  const Outcome outcome = npdr({"run", "command.toml", "--until", "simulate", "--set",
                                "method.num_simulations=70", "--set", "method.num_rounds=1"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const h5::File file = h5::File::open(runs("spring-worker") / "npe/seed-1/round-1/simulate.h5");
  const auto x = file.dataset("trajectories").read<float>();
  const RowMatrix theta = file.read_matrix<double>("theta");
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
  folder_.file("truth.toml", R"toml(
[study]
name = "truth"
[target]
truth = { pole_mass = 0.02 }
inputs = "recorded.h5"
[simulator]
name = "furuta"
[prior]
pole_mass = { uniform = [0.01, 0.03] }
[[method]]
name = "NPE"
num_simulations = 100
)toml");
  const Outcome outcome = npdr({"run", "truth.toml", "--until", "target"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
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
  const Outcome imported = npdr({"import", "rollout-0.csv", "rollout-1.csv", "--states",
                                 "x [m],theta [rad],x_dot [m/s],theta_dot [rad/s]", "--actions",
                                 "force [1]", "-o", "recording.h5"});
  ASSERT_EQ(imported.status, 0) << imported.err;
  std::vector<std::string> words = small("study.toml");
  words.insert(words.end(), {"--set", "target.num_rollouts=1", "--set",
                             "method.embedding.principal_components=20"});
  const Outcome outcome = npdr(words);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.out, {"floor", "held out"}));
}

}  // namespace
}  // namespace npdr::pipeline
