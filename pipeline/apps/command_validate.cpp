// The command that checks a study: what it implies, what its simulator gives.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>

#include "core/error.h"
#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/check.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_json.h"
#include "pipeline/config/study_keys.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

Index num_of(const Plan& plan, Stage stage) {
  return std::ranges::count(plan.nodes, stage, &Node::stage);
}

// Calibration may cost more than inference does, and small studies go without.
void print_calibration(const Plan& plan) {
  Index num_simulations = 0, num_posteriors = 0;
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::simulate && is_calibration(node)) {
      num_simulations += num_rows(plan, node);
    }
    if (node.stage != Stage::diagnose) continue;
    const MethodConfig& method = plan.study.method(node.uses.front().method);
    if (plan.study.diagnose_of(method).calibrates()) {
      num_posteriors += plan.study.diagnose.num_simulations;
    }
  }
  if (num_posteriors == 0) {
    const bool could_be = std::ranges::any_of(plan.study.methods, [&](const MethodConfig& method) {
      return traits_of(Check::coverage).why_unchecked(plan.study, method).empty();
    });
    fmt::print("calibration isn't checked{}\n",
               could_be ? "; a table [diagnose] in the study checks it" : "");
    return;
  }
  fmt::print("to check calibration: {} of the simulations, and {} posteriors sampled for them\n",
             num_simulations, num_posteriors);
}

// What is made of the posteriors, which costs simulations, too.
void print_judging(const Plan& plan) {
  const Study& study = plan.study;
  const bool simulates = study.source().simulates;
  const Index baselines = simulates ? num_of(plan, Stage::baseline) : 0;
  fmt::print(
      "to judge them: {}{} of {} samples{}\n", counted(num_of(plan, Stage::evaluate), "evaluation"),
      baselines > 0 ? " and " + counted(baselines, "baseline") : "", study.evaluate.num_samples,
      simulates ? ", each simulated" : ", none of them simulated");
  const Index diagnoses = num_of(plan, Stage::diagnose);
  if (diagnoses == 0) return;
  const bool predicts = study.diagnose.has(Check::predictive) || study.diagnose.has(Check::width);
  fmt::print("to check them: {} diagnos{}s, {} samples of each posterior{}\n", diagnoses,
             diagnoses == 1 ? "i" : "e", study.diagnose.num_samples,
             simulates && predicts ? ", those at the observation simulated" : "");
  print_calibration(plan);
}

void print_fits(const Plan& plan) {
  Index count = 0, simulations = 0;
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::infer) continue;
    const MethodConfig& method = plan.study.method(node.uses.front().method);
    if (family_of(method) != inference::AlgorithmFamily::fit) continue;
    ++count;
    simulations += method.least_squares.max_simulations;
  }
  if (count == 0) return;
  fmt::print("{}: at most {} simulations\n", counted(count, "least-squares fit"), simulations);
}

void print_refinements(const Plan& plan) {
  Index count = 0, simulations = 0;
  bool tries_powers = false, infers_first_states = false;
  for (const Node& node : plan.nodes) {
    if (!is_refinement(plan, node)) continue;
    ++count;
    const RefineConfig& config = plan.study.method(node.uses.front().method).refine;
    simulations += config.sampling.max_simulations;
    tries_powers |= config.sampling.cross_validate;
    infers_first_states |= config.infer_first_states;
  }
  if (count == 0) return;
  fmt::print(
      "{}: at most {} more simulations, until they are worth refine.min_ess draws{}{}\n",
      counted(count, "refinement"), simulations,
      tries_powers ? fmt::format(", and {} for each power that is tried", kLeftOutDraws) : "",
      infers_first_states ? "; each has a rollout more for every state channel where first "
                            "states are inferred"
                          : "");
}

void print_policy_searches(const Plan& plan) {
  const PolicyConfig& policy = plan.study.policy;
  if (!policy.is_used()) return;
  const Index trials = policy.num_domain_parameters * policy.num_initial_states;
  Index searches = 0, rollouts = 0, tests = 0;
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::policy_test) ++tests;
    if (node.stage != Stage::policy) continue;
    ++searches;
    const Index iterations = plan.study.method(node.uses.front().method).policy_iterations;
    rollouts += (iterations * (policy.search.population + 1) + 1) * trials;
  }
  fmt::print("policy searches: {} of {} rollouts together, and {}\n", searches, rollouts,
             counted(tests, "test"));
}

// Rollouts that each row of a simulation replays.
Index num_replayed(const Plan& plan, const Node& node) {
  const Study& study = plan.study;
  const Use& use = node.uses.front();
  const Index seen = num_rollouts_seen(study.method(use.method), use);
  if (seen > 0) return seen;
  const Index num_rollouts = study.target.recording
                                 ? plan.target.num_rollouts() - study.target.held_out
                                 : study.target.num_rollouts;
  const Index all = num_rollouts * std::max<Index>(1, use.iteration);
  const Index folds = study.evaluate.leave_out;
  return use.fold > 0 ? all - (all - use.fold + folds) / folds : all;
}

Index num_steps_of(const Plan& plan) {
  const auto& inputs = plan.study.target.inputs;
  if (plan.study.target.recording) return plan.target.num_steps();
  return inputs ? read_recording(*inputs).num_steps() : plan.source->info().num_steps;
}

// The work and disk that a study implies.
void print_work(const Plan& plan) {
  const Study& study = plan.study;
  const SourceTraits& source = study.source();
  Index rows = 0, rollouts = 0, shards = 0;
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::simulate) continue;
    rows += num_rows(plan, node);
    shards += num_shards(plan, node);
    if (source.gives_motion) rollouts += num_rows(plan, node) * num_replayed(plan, node);
  }
  Index values = rows * std::ssize(study.external.features);
  std::string work = source.simulates
                         ? fmt::format("{} simulations in {}", rows, counted(shards, "shard"))
                         : fmt::format("{} rows of the dataset", rows);
  work += fmt::format(", {} features each", study.external.features.size());
  if (source.gives_motion) {
    const Index steps = num_steps_of(plan);
    work = fmt::format("{} simulations ({} rollouts of {} steps)", rows, rollouts, steps);
    values = rollouts * (steps / study.simulator.store_every) *
             std::ssize(plan.source->info().state_channels);
  }
  fmt::print("{} artefacts: {}, {}, at most {} of {}\n", plan.nodes.size(), work,
             counted(num_of(plan, Stage::infer), "posterior"),
             size_text(static_cast<std::uintmax_t>(values) * sizeof(float)),
             source.gives_motion ? "trajectories" : "x");
  print_fits(plan);
  print_refinements(plan);
  print_judging(plan);
  print_policy_searches(plan);
}

// Of `npdr new`; whoever has made a line theirs takes the mark away.
void print_edit_marks(const std::filesystem::path& study) {
  std::ifstream file(study);
  std::vector<std::string> numbers;
  Index number = 1;
  for (std::string line; std::getline(file, line); ++number) {
    const std::string comment = line.substr(std::min(line.find('#'), line.size()));
    if (comment.find(" EDIT:") != std::string::npos || trimmed(comment) == "# EDIT")
      numbers.push_back(std::to_string(number));
  }
  if (numbers.empty()) return;
  fmt::print("still marked EDIT, as npdr new wrote: {} {}\n",
             numbers.size() == 1 ? "line" : "lines", join(numbers));
}

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

// Simulates the first `count` rows of the first round of the plan's first experiment, with their
// parameters and random numbers, and prints what went in, what came out and how long it took; of a
// study that only refines, draws of the prior. Writes no file. Throws InputError where rows are
// finished simulations; FailedRolloutsError where none of them gives a result.
void try_rows(const Plan& plan, Index count) {
  const Study& study = plan.study;
  if (!study.source().simulates) {
    throw InputError("--try: simulator.dataset has finished simulations, there is none to try");
  }
  const Use use = first_use(plan);
  Study alone = study;  // all rows by one call: a program may be wrong about several
  alone.external.parallel_calls = 1;
  const std::unique_ptr<Source> source = make_source(alone);
  const auto simulator = source->open(
      {.simulator = study.simulator, .target = replayed_target(plan, use), .seed = use.seed});
  const RowMatrix theta =
      inference::sample_prior(inference::Prior(study.prior), count, use.seed, use.stream_round());
  const auto start = std::chrono::steady_clock::now();
  const sim::Trajectories x = simulator->simulate(
      source->parameters().complete(theta),
      {use.seed, kSimulationStream, static_cast<std::uint64_t>(use.round), 0, 0});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  std::vector<Channel> parameters;
  for (const inference::Marginal& m : study.prior) parameters.push_back({m.name, m.unit});
  for (Index i = 0; i < count; ++i) {
    print_line("row {}: {}", i, numbers_text(parameters, theta.row(i)));
    print_line("  {}", result_text(plan, x, i));
  }
  print_line("{} in {:.3g} s", counted(count, "row"), taken.count());
  tell_of_failures(x, *simulator);
}

}  // namespace

Action validate_command(CLI::App& command) {
  auto study = std::make_shared<StudyArguments>();
  auto resolved = std::make_shared<bool>(false);
  study->add_to(command);
  command.add_flag("--resolved", *resolved, "print it with all defaults filled in, too (JSON)");
  command.add_flag("--quiet")->group("");  // scripts may still say it
  auto num_tries = std::make_shared<Index>(0);
  command
      .add_option("--try", *num_tries,
                  "simulate the first N rows, and print them: does the simulator work?")
      ->type_name("N")
      ->check(CLI::Range(1, 1000));
  command.footer("Examples:\n  npdr validate study.toml\n  npdr validate study.toml --try 3");
  return done_after([study, resolved, num_tries] {
    const Plan plan = study->plan();
    const bool has_motion = plan.study.target.recording && plan.study.source().gives_motion;
    if (has_motion) require_motion(plan.study, plan.target);
    if (*resolved) print_json(to_json(plan.study));
    print_work(plan);
    print_warnings("npdr validate", plan);
    print_edit_marks(study->file);
    if (*num_tries > 0) try_rows(plan, *num_tries);
  });
}

}  // namespace npdr::pipeline
