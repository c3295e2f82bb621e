#include "pipeline/apps/trial_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "core/error.h"
#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/features/observation.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

constexpr std::size_t kMostShown = 12;  // numbers of a row

// "mass = 1.2, length = 0.5"; units where there are any.
template <class Values>
std::string numbers_text(const std::vector<Channel>& names, const Values& values) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(names.size(), kMostShown); ++i) {
    const auto& [label, unit] = names[i];
    words.push_back(fmt::format("{} = {:.6g}{}{}", shortened(label), values[static_cast<Index>(i)],
                                unit == "1" ? "" : " ", unit == "1" ? "" : unit));
  }
  if (names.size() > kMostShown) words.emplace_back(fmt::format("... {} numbers", names.size()));
  return join(words);
}

std::vector<Channel> parameters_of(const Plan& plan) {
  std::vector<Channel> names;
  for (const inference::Marginal& m : plan.study.prior) names.push_back({m.name, m.unit});
  return names;
}

std::string result_text(const Plan& plan, const sim::Trajectories& x, Index row) {
  const sim::RolloutStatus status = x.status[static_cast<std::size_t>(row)];
  if (status != sim::RolloutStatus::ok) return std::string(sim::to_string(status));
  const std::vector<Channel>& channels = plan.source->info().state_channels;
  const Eigen::RowVectorXf last = x.rollout(row, x.num_rollouts - 1).bottomRows<1>();
  if (!plan.study.source().gives_motion) return "x: " + numbers_text(channels, last);
  return fmt::format("{} of {}; the last: {}", counted(x.num_rollouts, "rollout"),
                     counted(x.num_steps, "state"), numbers_text(channels, last));
}

// The first round of the first experiment. Studies that only refine have none.
Use first_use(const Plan& plan) {
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::simulate && node.uses.front().round == 1) return node.uses.front();
  }
  return {.seed = plan.study.seeds.front(), .round = 1};
}

// What its rows replay.
Target replayed_target(const Plan& plan, const Use& use) {
  if (!plan.study.source().gives_motion) return {};
  const Target used = make_seen_target(plan);
  const Index seen = use.method.empty() ? 0 : num_rollouts_seen(plan.study.method(use.method), use);
  return seen > 0 ? used.first(seen) : used;
}

// All rows by one call: a program may be wrong about several.
std::unique_ptr<Source> source_of_one_call(const Study& study) {
  Study alone = study;
  alone.external.parallel_calls = 1;
  return make_source(alone);
}

void tell_of_failures(const sim::Trajectories& x, const RowSimulator& simulator) {
  const Index good = std::ranges::count(x.status, sim::RolloutStatus::ok);
  const std::string last = simulator.last_failure();
  const std::string why = last.empty() ? "" : ": " + last;
  report_findings("npdr validate", simulator.last_warnings());
  if (good == 0) throw FailedRolloutsError("no row that was tried has a result" + why);
  if (good < x.num_rows) {
    report_warning("npdr validate",
                   fmt::format("{} of {} rows failed{}", x.num_rows - good, x.num_rows, why));
  } else if (!last.empty()) {
    report_warning("npdr validate",
                   "a call failed that went well when it was repeated, or with fewer rows" + why);
  }
}

}  // namespace

void try_rows(const Plan& plan, Index count) {
  const Study& study = plan.study;
  if (!study.source().simulates) {
    throw InputError("--try: simulator.dataset has finished simulations, there is none to try");
  }
  const Use use = first_use(plan);
  const std::unique_ptr<Source> source = source_of_one_call(study);
  const auto simulator = source->open(
      {.simulator = study.simulator, .target = replayed_target(plan, use), .seed = use.seed});
  const RowMatrix theta =
      inference::sample_prior(inference::Prior(study.prior), count, use.seed, use.stream_round());
  const auto start = std::chrono::steady_clock::now();
  const sim::Trajectories x = simulator->simulate(
      source->parameters().complete(theta),
      {use.seed, kSimulationStream, static_cast<std::uint64_t>(use.round), 0, 0});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  for (Index i = 0; i < count; ++i) {
    print_line("row {}: {}", i, numbers_text(parameters_of(plan), theta.row(i)));
    print_line("  {}", result_text(plan, x, i));
  }
  print_line("{} in {:.3g} s", counted(count, "row"), taken.count());
  tell_of_failures(x, *simulator);
}

}  // namespace npdr::pipeline
