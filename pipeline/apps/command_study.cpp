// Commands about study files: validate, new.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/new_study.h"
#include "pipeline/apps/trial_rows.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/check.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_json.h"
#include "pipeline/config/study_keys.h"
#include "pipeline/plan/completeness.h"

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
  fmt::print("to judge them: {}{} of {} samples{}{}\n",
             counted(num_of(plan, Stage::evaluate), "evaluation"),
             baselines > 0 ? " and " + counted(baselines, "baseline") : "",
             study.evaluate.num_samples,
             simulates ? ", each simulated" : ", none of them simulated",
             study.target.recording && study.evaluate.floor ? ", and a search for the floor" : "");
  const Index diagnoses = num_of(plan, Stage::diagnose);
  if (diagnoses == 0) return;
  const bool predicts = std::ranges::count(study.diagnose.checks, Check::predictive) > 0;
  fmt::print("to check them: {} diagnos{}s, {} samples of each posterior{}\n", diagnoses,
             diagnoses == 1 ? "i" : "e", study.diagnose.num_samples,
             simulates && predicts ? ", those at the observation simulated" : "");
  print_calibration(plan);
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
  fmt::print("{} artefacts: {}, {} to train, at most {} of {}\n", plan.nodes.size(), work,
             counted(num_of(plan, Stage::infer), "posterior"),
             size_text(static_cast<std::uintmax_t>(values) * sizeof(float)),
             source.gives_motion ? "trajectories" : "x");
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

void write_new_study(NewStudy wanted) {
  if (wanted.name.ends_with(".toml")) wanted.name.resize(wanted.name.size() - 5);
  const std::filesystem::path path = wanted.name + ".toml";
  const std::string text =
      wanted.is_specific() ? new_study_text(wanted) : study_template(wanted.name);
  if (std::filesystem::exists(path)) {
    throw InputError(path.string() + ": is there already; choose another name or remove it");
  }
  write_text_file(path, text);
  const bool needs_edits = text.find("EDIT") != std::string::npos;
  fmt::print("wrote {0}; {1}run it with: npdr run {0}\n", path.string(),
             needs_edits ? "edit the lines with EDIT, then " : "");
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
  return [study, resolved, num_tries] {
    const Plan plan = study->plan();
    const bool has_motion = plan.study.target.recording && plan.study.source().gives_motion;
    if (has_motion) require_motion(plan.study, plan.target);
    if (*resolved) print_json(to_json(plan.study));
    print_work(plan);
    print_warnings("npdr validate", plan);
    print_edit_marks(study->file);
    if (*num_tries > 0) try_rows(plan, *num_tries);
    return ExitStatus::done;
  };
}

Action new_command(CLI::App& command) {
  auto wanted = std::make_shared<NewStudy>();
  command.add_option("NAME", wanted->name, "of the study; NAME.toml is written")->required();
  command.add_option("--recording", wanted->recording, "recorded rollouts (npdr import)");
  command.add_option("--observation", wanted->observation, "x_o: CSV with one row, or HDF5");
  command.add_option("--simulator", wanted->simulator, "a built-in one (npdr list simulators)");
  command.add_option("--worker", wanted->worker, "program that stays: 'python3 sim.py'");
  command.add_option("--library", wanted->library, "shared library with npdr_simulator.h");
  command.add_option("--mjcf", wanted->mjcf, "model of MuJoCo");
  command.add_option("--dataset", wanted->dataset, "finished simulations (npdr import --theta)");
  command.add_option("--command", wanted->command, "program that reads and writes files");
  command.footer(
      "Examples:\n  npdr new spring --recording spring.h5 --worker 'python3 spring.py'\n"
      "  npdr new counts --observation x_o.csv --command 'python3 counts.py {theta} {x}'");
  return done_after([wanted] { write_new_study(*wanted); });
}

}  // namespace npdr::pipeline
