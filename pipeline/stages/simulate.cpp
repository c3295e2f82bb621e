#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/features/failures.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/process/progress.h"
#include "pipeline/sources/external_simulator.h"
#include "pipeline/sources/first_rows.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

constexpr Index kNumbersRead = Index{1} << 18;  // of x, at once

// Files and settings that all shards of a simulation share: shards may be so small that opening
// files for each would take longest.
struct Simulation {
  const Plan& plan;
  const Node& node;
  Target target;  // of a source that replays one
  h5::Dataset proposal;
  std::unique_ptr<RowSimulator> simulator;
  StreamId id;
  Index num_done = 0, num_failed = 0;  // rows of this process
};

Simulation make_simulation(const Plan& plan, const Node& node) {
  const Use& use = node.uses.front();
  const Target target = plan.study.source().gives_motion ? read_seen_target(plan, node) : Target{};
  return {.plan = plan,
          .node = node,
          .target = target,
          .proposal = open_proposal(plan.input(node, "proposal")),
          .simulator = plan.source->open({.simulator = plan.study.simulator,
                                          .target = target,
                                          .seed = use.seed,
                                          .num_rows = num_rows(plan, node)}),
          .id = {use.seed, kSimulationStream, static_cast<std::uint64_t>(use.round), 0, 0}};
}

constexpr Index kColumnsOfMotion = 40;

// Columns of x: all features, or some values of motion, evenly chosen.
std::vector<Index> judged_columns(const Simulation& simulation, Index row_size) {
  const bool gives_motion = simulation.plan.study.source().gives_motion;
  const Index count = gives_motion ? std::min(row_size, kColumnsOfMotion) : row_size;
  std::vector<Index> columns;
  for (Index c = 1; c <= count; ++c) columns.push_back(c * row_size / count - 1);
  return columns;
}

// What is wrong with rows of users' simulators, too seldom perhaps for the first ones to show it.
// Those of a dataset are judged in its own order (findings/dataset_probes.cpp).
Findings find_in_all(const Simulation& simulation, const std::vector<Shard>& shards) {
  const SourceTraits& source = simulation.plan.study.source();
  if (!source.runs_users_code()) return {};
  RowsTogether rows;
  if (!source.gives_motion) rows.features = simulation.plan.source->info().state_channels;
  for (const Shard& shard : shards) {
    const Identity identity = shard_identity(simulation.node.identity, shard.rows);
    const h5::File file = open_artefact({shard.path, identity.key()}, kSimulationShardSchema);
    const h5::Dataset values = simulated_values(file);
    if (!source.gives_motion) {
      values.require_shape({shard.rows.size(), std::ssize(rows.features)});
    }
    const RowMatrix theta = file.read_matrix<double>("theta", shard.rows.size(), -1);
    const std::vector<Index> columns = judged_columns(simulation, values.row_size());
    const Index most = std::max<Index>(1, kNumbersRead / std::max<Index>(1, values.row_size()));
    const Index last =
        std::min(values.num_rows(), num_rows_together(values.row_size()) - shard.rows.begin);
    if (last <= 0) break;
    rows.theta.conservativeResize(shard.rows.begin + last, theta.cols());
    rows.x.conservativeResize(shard.rows.begin + last, std::ssize(columns));
    rows.theta.bottomRows(last) = theta.topRows(last);
    for (Index begin = 0; begin < last; begin += most) {
      RowMatrixF x(std::min(most, last - begin), values.row_size());
      values.read_rows<float>(begin, x.rows(), {x.data(), static_cast<std::size_t>(x.size())});
      rows.x.middleRows(shard.rows.begin + begin, x.rows()) = x(Eigen::all, columns);
    }
  }
  return find_apart(rows);
}

// The first rows of an experiment are a block of their own, so that what is found doesn't depend on
// shards and calls.
constexpr Index kCheckedRows = 64;

bool is_checked(const Simulation& simulation, Index row) {
  return row == 0 && simulation.node.uses.front().round == 1;
}

Index count_failed(const std::vector<sim::RolloutStatus>& status) {
  return std::ssize(status) - std::ranges::count(status, sim::RolloutStatus::ok);
}

// Why the others aren't simulated: so many of the `num_rows` that were have failed.
[[noreturn]] void stop_for_failures(const Simulation& simulation, Index num_failed, Index num_rows,
                                    const char* which) {
  const Study& study = simulation.plan.study;
  const std::string last = simulation.simulator->last_failure();
  throw FailedRolloutsError(fmt::format(
      "{}: {} of {}{} rows failed ({:.3g} %), limits.max_failed_fraction = {}: others aren't "
      "simulated; {}{}",
      simulation.node.label(), num_failed, which, num_rows,
      100.0 * static_cast<double>(num_failed) / static_cast<double>(num_rows),
      study.limits.max_failed_fraction, study.source().advice,
      last.empty() ? "" : "; for example: " + last));
}

// A study of whose first rows too many fail has no use for the others of a user's simulator.
void require_good_beginning(const Simulation& simulation, const GivenRows& rows) {
  const Index count = rows.complete.rows();
  const bool are_all = count == num_rows(simulation.plan, simulation.node);
  if (are_all || count < kCheckedRows || !simulation.plan.study.source().runs_users_code()) return;
  const Index num_failed = count_failed(rows.result.status);
  const double limit = simulation.plan.study.limits.max_failed_fraction;
  if (chance_of_failures(num_failed, count, limit) > kHopelessChance) return;
  stop_for_failures(simulation, num_failed, count, "the first ");
}

// The same once more rows have failed than may of all, whatever becomes of the others.
void require_hope(const Simulation& simulation) {
  const auto all = static_cast<double>(num_rows(simulation.plan, simulation.node));
  const double most = simulation.plan.study.limits.max_failed_fraction * all;
  const bool is_hopeless = static_cast<double>(simulation.num_failed) > most;
  if (!is_hopeless || !simulation.plan.study.source().runs_users_code()) return;
  stop_for_failures(simulation, simulation.num_failed, simulation.num_done, "");
}

// Tells people at once, and the report for good, what is probably wrong with rows. It has
// what all rows together say.
std::vector<std::string> check_block(const Simulation& simulation, const GivenRows& given) {
  require_good_beginning(simulation, given);
  const FirstRows rows{simulation.plan.study, simulation.target,
                       simulation.plan.source->info().state_channels, *simulation.simulator, given};
  const bool are_all = given.complete.rows() == num_rows(simulation.plan, simulation.node);
  const Findings found = find_in_first_rows(rows);
  if (!are_all) report_findings(simulation.node.label(), find_apart_in_first(rows));
  report_findings(simulation.node.label(), found);
  std::vector<std::string> words;
  for (const Finding& finding : found) words.push_back(finding.what);
  return words;
}

// A shard may be smaller than what is looked at.
std::vector<std::string> check_first_rows(const Simulation& simulation, const GivenRows& given) {
  const Index count = std::min(kCheckedRows, num_rows(simulation.plan, simulation.node));
  if (given.complete.rows() >= count) return check_block(simulation, given);
  const RowMatrix complete =
      simulation.plan.source->parameters().complete(read_proposal(simulation.proposal, {0, count}));
  const sim::Trajectories result = simulation.simulator->simulate(complete, given.first);
  return check_block(simulation, {complete, result, given.first});
}

// The rows after those, as many as a call takes: programs may treat a full one in another way.
void check_second_block(const Simulation& simulation, const GivenRows& given,
                        std::vector<std::string>& warnings) {
  const Findings found = check_late_rows(*simulation.simulator, given);
  if (found.empty() || std::ranges::count(warnings, found.front().what) > 0) return;
  report_findings(simulation.node.label(), found);
  warnings.push_back(found.front().what);
}

// Rows [begin, begin + count) of the simulation, from row `at` of the shard's file. `warnings` of
// the shard grow by theirs.
void write_block(h5::File& file, Simulation& simulation, Index begin, Index at, Index count,
                 std::vector<std::string>& warnings) {
  const auto start = Clock::now();
  const RowMatrix theta = read_proposal(simulation.proposal, {begin, begin + count});
  StreamId first = simulation.id;
  first.row = static_cast<std::uint64_t>(begin);
  const RowMatrix complete = simulation.plan.source->parameters().complete(theta);
  const sim::Trajectories result = simulation.simulator->simulate(complete, first);
  const double seconds = seconds_since(start);
  simulation.num_done += count;
  simulation.num_failed += count_failed(result.status);
  const std::vector<float> row_seconds(static_cast<std::size_t>(count),
                                       static_cast<float>(seconds / static_cast<double>(count)));
  const std::vector<std::uint8_t> status = as_bytes(result.status);
  file.dataset("theta").write_rows<double>(at, count,
                                           {theta.data(), static_cast<std::size_t>(theta.size())});
  simulated_values(file).write_rows<float>(at, count, result.values);
  file.dataset("status").write_rows<std::uint8_t>(at, count, status);
  file.dataset("seconds").write_rows<float>(at, count, row_seconds);
  if (is_checked(simulation, begin)) {
    warnings = check_first_rows(simulation, {complete, result, first});
  }
  const bool is_second = begin == kCheckedRows && is_checked(simulation, 0);
  if (is_second && simulation.plan.study.source().takes_seeds) {
    check_second_block(simulation, {complete, result, first}, warnings);
  }
}

void simulate_shard(Simulation& simulation, const Shard& shard, Index done_before,
                    Progress& progress) {
  const Index count = shard.rows.size();
  // Of this machine, to write in first: many small writes over a network are slow.
  const char* const scratch = std::getenv("NPDR_SCRATCH");
  ArtefactWriter writer(shard.path, kSimulationShardSchema,
                        shard_identity(simulation.node.identity, shard.rows),
                        scratch == nullptr ? "" : scratch);
  create_simulation_datasets(writer.file(), simulation.plan.study, simulation.target, count);
  simulation.simulator->log_to(log_of(shard.path));
  std::vector<std::string> warnings;
  for (Index at = 0, rows = 0; at < count; at += rows) {
    stop_here_if_requested();
    require_hope(simulation);
    const bool is_first = is_checked(simulation, shard.rows.begin + at);
    const Index block = is_first ? kCheckedRows : simulation.simulator->block_size(count);
    rows = std::min(block, count - at);
    write_block(writer.file(), simulation, shard.rows.begin + at, at, rows, warnings);
    progress.update(done_before + at + rows, simulation.num_failed > 0
                                                 ? fmt::format("{} failed", simulation.num_failed)
                                                 : "");
  }
  simulation.simulator->log_to({});
  write_warnings(writer.file(), warnings);
  writer.finish();
}

// The report counts rows that failed; why they did, and for which parameters, is known here.
void warn_of_failures(const Simulation& simulation) {
  const Plan& plan = simulation.plan;
  const Node& node = simulation.node;
  const h5::File file = open_artefact(node, kSimulationSchema);
  const bool are_few = too_many_failed(plan, node, file).empty();
  // Where a simulator of ours fails, parameters are impossible indeed.
  if (plan.study.source().is_built_in && are_few) return;
  const auto num_failed = file.attribute<Index>("num_failed");
  const std::string last = simulation.simulator->last_failure();
  if (num_failed > 0) {
    const std::string where = where_failures_lie(plan, node);
    Finding said = warning(fmt::format(
        "{} of {} rows failed ({}){}{}", num_failed, num_rows(plan, node), failures(file),
        where.empty() ? "" : "; " + where, last.empty() ? "" : "; for example: " + last));
    if (are_few) said.severity = Severity::note;
    report_findings(node.label(), {said});
  } else if (!last.empty()) {
    report_warning(
        node.label(),
        "calls failed that went well when they were repeated, or with fewer rows, which takes much "
        "longer; a simulator of many rows at once must take any number of them; for example: " +
            last);
  }
}

}  // namespace

template <>
void run<Stage::simulate>(const Plan& plan, const Node& node,
                          const std::vector<Index>& shard_numbers) {
  const std::vector<Shard> all = shards(plan, node);
  std::vector<Index> numbers = shard_numbers;
  for (Index i = 0; shard_numbers.empty() && i < std::ssize(all); ++i) numbers.push_back(i);
  Simulation simulation = make_simulation(plan, node);
  std::vector<const Shard*> missing;
  Index done = 0;
  for (const Index number : numbers) {
    require_shard(plan, node, number);
    const Shard& shard = all[static_cast<std::size_t>(number)];
    if (std::filesystem::exists(shard.path)) {
      done += shard.rows.size();
    } else {
      missing.push_back(&shard);
    }
  }
  Progress progress(node.label(), num_rows(plan, node), done);
  for (const Shard* shard : missing) {
    simulate_shard(simulation, *shard, done, progress);
    done += shard->rows.size();
  }
  if (missing_shards(plan, node).empty()) {
    const Findings found = find_in_all(simulation, all);
    report_findings(node.label(), found);
    std::vector<std::string> words;
    for (const Finding& finding : found) words.push_back(finding.what);
    join_shards(node, node.identity, plan.study, simulation.target, all, words);
    link_uses(plan, node);  // one can look at it also where too many rows failed
    warn_of_failures(simulation);
    open_simulation(plan, node);
  }
}

}  // namespace npdr::pipeline
