// Cost of asking a simulator of the user's in place of calling it: rows a second through a
// worker against the same function of Python called directly, through a library against the same
// function of C linked into this program, through the library for MuJoCo against mujoco.rollout.
// Every pair does the same work on one thread, in turn; the best of several repetitions counts.
//
//   OMP_NUM_THREADS=1 build/release/bench/bench_sources
//   OMP_NUM_THREADS=1 build/release/bench/bench_sources PYTHON    one with numpy, for the last pair
//   mujoco
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>

#include "core/atomic_file.h"
#include "core/shell_call.h"
#include "pipeline/sources/program_call.h"
#include "sim/library/library_simulator.h"
#include "sim/library/npdr_simulator.h"
#include "sim/simulator.h"

namespace {

using namespace npdr;
using Clock = std::chrono::steady_clock;

constexpr int kRepetitions = 5;

double best_seconds(const std::function<void()>& run) {
  run();  // starts what has to be started
  double best = 1e300;
  for (int i = 0; i < kRepetitions; ++i) {
    const auto start = Clock::now();
    run();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

void print_row(const std::string& pair, Index rows, double direct, double ours) {
  const auto n = static_cast<double>(rows);
  fmt::print("| {:<42} | {:>12.3g} | {:>12.0f} | {:>12.0f} | {:>6.1f} % |\n", pair,
             1e6 * direct / n, n / direct, n / ours, 100.0 * direct / ours);
  std::fflush(stdout);
}

std::vector<std::uint32_t> seeds(Index rows) {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(rows));
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Target rollout(const std::vector<Channel>& states, const std::vector<Channel>& actions, double dt,
               Index steps) {
  Target target;
  target.dt = dt;
  target.state_channels = states;
  target.action_channels = actions;
  const auto width = static_cast<Index>(states.size());
  target.rollouts = {{"0", RowMatrix::Constant(steps + 1, width, 0.1),
                      RowMatrix::Constant(steps, static_cast<Index>(actions.size()), 0.2)}};
  return target;
}

// A mass on a spring in numpy, all rows at once; alone it times itself.
constexpr const char* kSpring = R"py(
import sys, time
import numpy as np

def simulate(theta, first_state, actions, dt, seeds):
    q = np.full(len(seeds), first_state[0])
    v = np.full(len(seeds), first_state[1])
    states = np.empty((len(seeds), len(actions), 2))
    for t in range(len(actions)):
        for _ in range(SUBSTEPS):
            v = v + dt / SUBSTEPS * (actions[t, 0] - theta["stiffness"] * q - theta["damping"] * v)
            q = q + dt / SUBSTEPS * v
        states[:, t, 0], states[:, t, 1] = q, v
    return states

SUBSTEPS, STEPS, ROWS = (int(a) for a in sys.argv[1:4])
if len(sys.argv) > 4:
    best = 1e300
    theta = {"stiffness": np.linspace(10, 30, ROWS), "damping": np.full(ROWS, 0.3)}
    for i in range(6):
        start = time.perf_counter()
        simulate(theta, np.array([0.1, 0.1]), np.full((STEPS, 1), 0.2), 0.02, np.arange(ROWS))
        if i: best = min(best, time.perf_counter() - start)
    print(best)
else:
    import npdr_worker
    npdr_worker.serve(simulate, batch=True)
)py";

// Seconds that a program prints as its last line.
double printed_seconds(const std::string& command, const std::filesystem::path& folder) {
  const npdr::CallResult result = npdr::run_shell({{command, folder, {}}, 600.0});
  if (!result.succeeded()) {
    fmt::print(stderr, "{}: {}\n{}", command, result.words(600.0), result.output);
    return 0.0;
  }
  return std::atof(result.output.c_str());
}

void bench_worker(const std::string& python, const std::filesystem::path& folder, Index rows,
                  Index steps, Index substeps) {
  const std::string program = fmt::format("{} spring.py {} {} {}", python, substeps, steps, rows);
  const double direct = printed_seconds(program + " alone", folder);
  if (direct == 0.0) return;
  pipeline::Program worker;
  worker.external.worker = program;
  worker.external.folder = folder;
  sim::SimulatorInfo& info = worker.info;
  info.parameters = {{.name = "stiffness", .unit = "N/m", .description = ""},
                     {.name = "damping", .unit = "N s/m", .description = ""}};
  info.state_channels = {{"q", "m"}, {"v", "m/s"}};
  info.action_channels = {{"force", "N"}};
  const Target target = rollout(info.state_channels, info.action_channels, 0.02, steps);
  worker.segments = sim::cut(target, 0);
  const auto call = pipeline::make_worker_call(worker);
  RowMatrix theta(rows, 2);
  theta.col(0).setLinSpaced(rows, 10.0, 30.0);
  theta.col(1).setConstant(0.3);
  const auto row_seeds = seeds(rows);
  sim::Trajectories result = sim::empty_trajectories(worker.segments, rows, 1);
  const double ours = best_seconds([&] {
    const pipeline::ProgramReply reply = call->call({theta, row_seeds, 0, 600.0});
    if (!reply.succeeded()) fmt::print(stderr, "{}\n{}", reply.problem, reply.output);
    for (Index i = 0; reply.succeeded() && i < rows; ++i) {
      sim::store_states(worker.segments, reply.states.data() + 2 * steps * i, 1, i, result);
    }
  });
  print_row(fmt::format("worker, numpy, {} steps of {}", steps, substeps), rows, direct, ours);
}

// The spring of the examples in C: loaded as a library, and linked into this program.
void bench_library(const std::filesystem::path& library, Index rows, Index steps) {
  const sim::LibrarySimulator loaded({library});
  const Target target =
      rollout(loaded.info().state_channels, loaded.info().action_channels, 0.02, steps);
  const sim::Segments segments = sim::cut(target, 0);
  RowMatrix theta = RowMatrix::Constant(rows, 4, 0.3);
  theta.col(1).setLinSpaced(rows, 10.0, 30.0);
  const auto row_seeds = seeds(rows);
  std::vector<double> states(static_cast<std::size_t>(rows * steps * 2));
  std::vector<std::uint8_t> status(static_cast<std::size_t>(rows));
  const npdr_batch batch = {rows,
                            1,
                            steps,
                            0.02,
                            theta.data(),
                            row_seeds.data(),
                            segments.steps.data(),
                            segments.past.data(),
                            segments.first_states.data(),
                            segments.actions.data()};
  const double direct = best_seconds(
      [&] { npdr_simulator()->replay(nullptr, &batch, states.data(), status.data(), nullptr); });
  const double ours = best_seconds([&] { loaded.replay(segments, 1, theta, row_seeds); });
  print_row(fmt::format("library, spring in C, {} steps", steps), rows, direct, ours);
}

constexpr const char* kRollout = R"py(
import copy, sys, time
import mujoco, numpy as np
from mujoco import rollout

STEPS, SUBSTEPS, ROWS = (int(a) for a in sys.argv[1:4])
model = mujoco.MjModel.from_xml_path("cartpole.xml")
models = []
for damping in np.linspace(0.1, 1.0, ROWS):
    one = copy.copy(model)
    one.dof_damping[0] = damping
    models.append(one)
data = mujoco.MjData(model)
data.qpos[:], data.qvel[:] = 0.1, 0.1
state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
states = np.tile(state, (ROWS, 1))
control = np.full((ROWS, STEPS * SUBSTEPS, 1), 0.2)
best = 1e300
with rollout.Rollout(nthread=0) as roll:
    for i in range(6):
        start = time.perf_counter()
        roll.rollout(models, [data], states, control)
        if i: best = min(best, time.perf_counter() - start)
print(best)
)py";

void bench_mujoco(const std::string& python, const std::filesystem::path& folder,
                  const std::filesystem::path& library, Index rows, Index steps, Index substeps) {
  const double direct =
      printed_seconds(fmt::format("{} rollout.py {} {} {}", python, steps, substeps, rows), folder);
  if (direct == 0.0) return;
  const sim::LibrarySimulator model(
      {library, fmt::format(R"({{"model": "{}", "parameters": ["joint.x.damping"], "states": [],
                                 "actions": []}})",
                            (folder / "cartpole.xml").string())});
  const Target target = rollout(model.info().state_channels, model.info().action_channels,
                                0.002 * static_cast<double>(substeps), steps);
  const sim::Segments segments = sim::cut(target, 0);
  RowMatrix theta(rows, 1);
  theta.col(0).setLinSpaced(rows, 0.1, 1.0);
  const auto row_seeds = seeds(rows);
  const double ours = best_seconds([&] { model.replay(segments, 1, theta, row_seeds); });
  print_row(fmt::format("MuJoCo, cart-pole, {} steps of {}", steps, substeps), rows, direct, ours);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string python = argc > 1 ? argv[1] : "python3";
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::filesystem::path folder =
      temporary_name(std::filesystem::temp_directory_path() / "bench_sources");
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "spring.py") << kSpring;
  std::ofstream(folder / "rollout.py") << kRollout;
  std::filesystem::copy(NPDR_SOURCE_DIR "/experiments/external/cartpole/cartpole.xml", folder);
  setenv("PYTHONPATH", (here.parent_path() / "lib").c_str(), 1);
  fmt::print("| {:<42} | {:>12} | {:>12} | {:>12} | {:>8} |\n", "", "us a row", "direct [1/s]",
             "npdr [1/s]", "ratio");
  fmt::print("|:{:-<42}-|-{:->12}:|-{:->12}:|-{:->12}:|-{:->8}:|\n", "", "", "", "", "");
  bench_worker(python, folder, 4096, 50, 20);
  bench_worker(python, folder, 1024, 250, 10);
  bench_worker(python, folder, 64, 1000, 250);
  bench_library(here / "bench_spring.so", 10'000, 25);
  bench_library(here / "bench_spring.so", 1000, 1000);
  bench_library(here / "bench_spring.so", 32, 25'000);
  const std::filesystem::path mujoco = here.parent_path() / "lib/npdr_mujoco.so";
  if (std::filesystem::exists(mujoco)) {
    bench_mujoco(python, folder, mujoco, 1000, 1, 10);
    bench_mujoco(python, folder, mujoco, 1000, 100, 1);
    bench_mujoco(python, folder, mujoco, 50, 1000, 10);
  }
  std::filesystem::remove_all(folder);
  return 0;
}
