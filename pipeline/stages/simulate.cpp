#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/external/dataset_rows.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/run/progress.h"
#include "pipeline/run/stop_request.h"
#include "pipeline/stages/row_simulator.h"
#include "pipeline/stages/simulation_file.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Rows that are simulated and written at once: bounds memory, and is a multiple of every batch.
constexpr Index kBlock = 256;

constexpr Index kDatasetBlock = 4096;  // the same of a dataset, whose rows cost next to nothing

using Clock = std::chrono::steady_clock;

// One simulation: what all of its shards share.
struct Simulation {
  const Plan& plan;
  const Node& node;
  sim::SimulatorInfo info;
  Target target;  // of a built-in simulator, which replays it
};

Simulation make_simulation(const Plan& plan, const Node& node) {
  Simulation simulation{plan, node, simulator_info(plan.study), {}};
  if (!plan.study.external.is_used()) {
    simulation.target = read_seen_target(plan, node);
  }
  return simulation;
}

// Where rows come from: theta from the proposal, what is simulated from a simulator or a dataset.
// One serves all shards, which may be so small that opening files for each would take longest.
class RowSource {
 public:
  explicit RowSource(const Simulation& simulation)
      : simulation_(simulation),
        id_(identity_of(simulation.node)),
        proposal_(open_proposal(*simulation.plan.inputs(simulation.node, Stage::propose).front())) {
    const Plan& plan = simulation.plan;
    if (!plan.study.external.dataset) return;
    dataset_.emplace(open_dataset(plan.study));
    dataset_rows_ = dataset_rows(id_.seed, dataset_->num_rows(), num_rows(plan, simulation.node));
  }

  // A command's output is logged beside its shard.
  void begin_shard(const std::filesystem::path& shard) {
    const Plan& plan = simulation_.plan;
    if (dataset_ || (simulator_ && !plan.study.external.command)) return;
    simulator_ = make_row_simulator(plan, plan.study.simulator, simulation_.target, log_of(shard));
  }
  // Completes the log.
  void end_shard() {
    if (simulation_.plan.study.external.command) simulator_.reset();
  }

  RowMatrix theta(RowRange rows) const { return read_proposal(proposal_, rows); }

  // Rows [begin, begin + theta.rows()) of the simulation.
  sim::Trajectories simulate(Index begin, const RowMatrix& theta) const {
    if (dataset_) {
      const auto picked =
          std::span(dataset_rows_)
              .subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(theta.rows()));
      return as_simulated(simulation_.plan.study, theta, dataset_->x(picked));
    }
    StreamId first = id_;
    first.row = static_cast<std::uint64_t>(begin);
    return simulator_->simulate(complete_theta(simulation_.plan, simulation_.info, theta), first);
  }

 private:
  static StreamId identity_of(const Node& node) {
    const Use& use = node.uses.front();
    return {use.seed, kSimulationStream, static_cast<std::uint64_t>(use.round), 0, 0};
  }

  const Simulation& simulation_;
  StreamId id_;
  h5::Dataset proposal_;
  std::unique_ptr<RowSimulator> simulator_;
  std::optional<DatasetFile> dataset_;
  std::vector<Index> dataset_rows_;
};

// A folder of this machine, where shards are written first: many small writes over a network are
// slow.
std::filesystem::path scratch_folder() {
  const char* const folder = std::getenv("NPDR_SCRATCH");
  return folder == nullptr ? "" : folder;
}

void write_block(h5::File& file, const RowSource& source, RowRange rows, Index at, Index count) {
  const auto start = Clock::now();
  const RowMatrix theta = source.theta({rows.begin + at, rows.begin + at + count});
  const sim::Trajectories result = source.simulate(rows.begin + at, theta);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::vector<float> row_seconds(static_cast<std::size_t>(count),
                                       static_cast<float>(seconds / static_cast<double>(count)));
  const std::vector<std::uint8_t> status = as_bytes(result.status);
  file.dataset("theta").write_rows<double>(at, count,
                                           {theta.data(), static_cast<std::size_t>(theta.size())});
  simulated_values(file).write_rows<float>(at, count, result.values);
  file.dataset("status").write_rows<std::uint8_t>(at, count, status);
  file.dataset("seconds").write_rows<float>(at, count, row_seconds);
}

void simulate_shard(const Simulation& simulation, RowSource& source, RowRange rows,
                    Index done_before, Progress& progress) {
  const Plan& plan = simulation.plan;
  const Index count = rows.end - rows.begin;
  const std::filesystem::path path = plan.work.shard(simulation.node.key, rows.begin, rows.end);
  ArtefactWriter writer(path, kSimulationShardSchema, shard_identity(simulation.node, rows),
                        scratch_folder());
  create_simulation_datasets(writer.file(), plan, simulation.target, count);
  source.begin_shard(path);
  // A command is called once for all of them: starting it may cost more than its work.
  const Index block = plan.study.external.command   ? count
                      : plan.study.external.dataset ? kDatasetBlock
                                                    : kBlock;
  for (Index at = 0; at < count; at += block) {
    stop_here_if_requested();
    write_block(writer.file(), source, rows, at, std::min(block, count - at));
    progress.update(done_before + std::min(at + block, count));
  }
  source.end_shard();
  writer.finish();
}

std::vector<Index> all_shards(std::size_t count) {
  std::vector<Index> numbers(count);
  std::iota(numbers.begin(), numbers.end(), Index{0});
  return numbers;
}

}  // namespace

void run_simulate(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers) {
  const std::vector<RowRange> ranges = shards(plan, node);
  const std::vector<Index> numbers =
      shard_numbers.empty() ? all_shards(ranges.size()) : shard_numbers;
  const Simulation simulation = make_simulation(plan, node);
  RowSource source(simulation);
  Progress progress(node.label(), num_rows(plan, node));
  Index done = 0;
  for (const Index number : numbers) {
    require_shard(plan, node, number);
    const RowRange rows = ranges[static_cast<std::size_t>(number)];
    const bool is_there = std::filesystem::exists(plan.work.shard(node.key, rows.begin, rows.end));
    if (!is_there) simulate_shard(simulation, source, rows, done, progress);
    done += rows.end - rows.begin;
  }
  if (missing_shards(plan, node).empty()) {
    join_shards(plan, node, simulation.target);
    link_uses(plan, node);  // one can look at it also where too many rows failed
    check_failed_rows(plan, node);
  }
}

}  // namespace npdr::pipeline
