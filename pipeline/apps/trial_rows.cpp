#include "pipeline/apps/trial_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "core/error.h"
#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/artefacts/feature_file.h"
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

// What rows are to replay.
Target replayed_target(const Plan& plan) {
  if (!plan.study.source().gives_motion) return {};
  return plan.study.target.recording ? plan.target : plan.source->behave({});
}

}  // namespace

void try_rows(const Plan& plan, Index count) {
  const Study& study = plan.study;
  if (!study.source().simulates) {
    throw InputError("--try: simulator.dataset has finished simulations, there is none to try");
  }
  const std::uint64_t seed = study.seeds.front();
  const auto simulator = plan.source->open({.simulator = study.simulator,
                                            .target = replayed_target(plan),
                                            .seed = seed,
                                            .num_rows = count});
  const RowMatrix theta = inference::sample_prior(inference::Prior(study.prior), count, seed, 1);
  const auto start = std::chrono::steady_clock::now();
  const sim::Trajectories x = simulator->simulate(plan.source->parameters().complete(theta),
                                                  {seed, kSimulationStream, 1, 0, 0});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  for (Index i = 0; i < count; ++i) {
    fmt::print("row {}: {}\n  {}\n", i, numbers_text(parameters_of(plan), theta.row(i)),
               result_text(plan, x, i));
  }
  fmt::print("{} in {:.2g} s\n", counted(count, "row"), taken.count());
  const Index good = std::ranges::count(x.status, sim::RolloutStatus::ok);
  const std::string last = simulator->last_failure();
  if (good > 0 && !last.empty()) report_error("npdr validate", "warning: " + last);
  if (good > 0) return;
  throw FailedRolloutsError(fmt::format(
      "{}{}", count == 1 ? "the row that was tried failed" : "all rows that were tried failed",
      last.empty() ? "" : ": " + last));
}

}  // namespace npdr::pipeline
