// Commands about study files: validate, new, list.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/new_study.h"
#include "pipeline/apps/size_text.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/study_json.h"
#include "pipeline/config/study_keys.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/config/study_template.h"
#include "pipeline/plan/shards.h"

namespace npdr::pipeline {
namespace {

void print_diagnoses(Index count, const Study& study) {
  if (count == 0) return;
  fmt::print("to check them: {} diagnos{}s, {} samples of each posterior\n", count,
             count == 1 ? "i" : "e", study.diagnose.num_samples);
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

// The same where simulations are vectors.
void print_feature_work(const Plan& plan) {
  const Study& study = plan.study;
  const auto num_features = static_cast<Index>(study.external.features.size());
  Index rows = 0, num_shards = 0, posteriors = 0, evaluations = 0, diagnoses = 0;
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::infer) ++posteriors;
    if (node.stage == Stage::evaluate) ++evaluations;
    if (node.stage == Stage::diagnose) ++diagnoses;
    if (node.stage != Stage::simulate) continue;
    rows += num_rows(plan, node);
    num_shards += static_cast<Index>(shards(plan, node).size());
  }
  const std::string source = study.source().simulates
                                 ? fmt::format("simulations in {}", counted(num_shards, "shard"))
                                 : "rows of the dataset";
  fmt::print("{} artefacts: {} {}, {} features each, {} to train, at most {} of x\n",
             plan.nodes.size(), rows, source, num_features, counted(posteriors, "posterior"),
             size_text(static_cast<std::uintmax_t>(rows * num_features) * sizeof(float)));
  fmt::print("to judge them: {} of {} samples{}\n", counted(evaluations, "evaluation"),
             study.evaluate.num_samples,
             study.source().simulates ? "" : ", none of them simulated");
  print_diagnoses(diagnoses, study);
}

// The work and disk that a study implies.
void print_work(const Plan& plan) {
  const Study& study = plan.study;
  if (!study.source().gives_motion) return print_feature_work(plan);
  const bool is_recorded = study.target.recording.has_value();
  const auto& inputs = study.target.inputs;
  const sim::SimulatorInfo& info = plan.source->info();
  const Index num_rollouts =
      is_recorded ? plan.target.num_rollouts() - study.target.held_out : study.target.num_rollouts;
  const Index num_steps = is_recorded ? plan.target.num_steps()
                          : inputs    ? read_recording(*inputs).num_steps()
                                      : info.num_steps;
  const auto num_states = static_cast<Index>(info.state_channels.size());
  Index evaluations = 0, diagnoses = 0, rows = 0, posteriors = 0, bytes = 0, rollouts = 0;
  for (const Node& node : plan.nodes) {
    if (node.stage == Stage::infer) ++posteriors;
    if (node.stage == Stage::evaluate) ++evaluations;
    if (node.stage == Stage::diagnose) ++diagnoses;
    if (node.stage != Stage::simulate) continue;
    const MethodConfig& method = study.method(node.uses.front().method);
    const Index h = (method.num_rollouts > 0 ? method.num_rollouts : num_rollouts) *
                    std::max<Index>(1, node.uses.front().iteration);
    rows += num_rows(plan, node);
    rollouts += num_rows(plan, node) * h;
    bytes += num_rows(plan, node) * h * (num_steps / study.simulator.store_every) * num_states *
             static_cast<Index>(sizeof(float));
  }
  fmt::print(
      "{} artefacts: {} simulations ({} rollouts of {} steps), {} to train, "
      "at most {} of trajectories\n",
      plan.nodes.size(), rows, rollouts, num_steps, counted(posteriors, "posterior"),
      size_text(static_cast<std::uintmax_t>(bytes)));
  fmt::print("to judge them: {} of {} samples{}\n", counted(evaluations, "evaluation"),
             study.evaluate.num_samples,
             is_recorded && study.evaluate.floor ? ", and a search for the floor" : "");
  print_diagnoses(diagnoses, study);
  print_policy_searches(plan);
}

void list_simulator(const sim::SimulatorInfo& info) {
  fmt::print("{}: {}\n", info.name, info.description);
  for (const sim::Parameter& p : info.parameters) {
    fmt::print("    {:<24} {:>10.6g} {:<12} {}\n", p.name, p.nominal, p.unit, p.description);
  }
}

std::string limits_text(const sim::Parameter& p) {
  const bool is_limited = std::isfinite(p.lower) || std::isfinite(p.upper);
  return is_limited ? fmt::format("[{:g}, {:g}]", p.lower, p.upper) : "";
}

// All that npdr knows of the simulator of a study.
void list_simulator_of(const std::string& file) {
  const Study study = read_study(file, {});
  const auto source = make_source(study);
  const sim::SimulatorInfo& info = source->info();
  fmt::print("{}: {}\nparameters:\n", info.name, info.description);
  for (const sim::Parameter& p : info.parameters) {
    const std::string nominal = std::isnan(p.nominal) ? "none" : fmt::format("{:.6g}", p.nominal);
    fmt::print("    {:<24} {:>10} {:<12} {:<16} {}\n", p.name, nominal, p.unit, limits_text(p),
               p.description);
  }
  const auto list_channels = [](const char* title, const std::vector<Channel>& channels) {
    fmt::print("{}:\n", title);
    for (const Channel& channel : channels) {
      fmt::print("    {:<24} {:>10} {}\n", channel.label, "", channel.unit);
    }
  };
  const bool gives_motion = study.source().gives_motion;
  list_channels(gives_motion ? "states" : "features", info.state_channels);
  if (gives_motion) list_channels("actions", info.action_channels);
  if (info.goal) fmt::print("goal: {}\n", info.goal->description);
}

void list_simulators(const std::string& study) {
  if (!study.empty()) return list_simulator_of(study);
  for (const std::string& name : sim::simulator_names()) {
    sim::SimulatorConfig config;
    config.name = name;
    list_simulator(sim::make_simulator(config)->info());
  }
}

void list_keys() {
  for (const StudyKey& key : study_keys()) {
    fmt::print("{:<44} {}", key.path, key.doc);
    if (!key.default_value.empty()) fmt::print("; default {}", key.default_value);
    if (!key.allowed.empty()) fmt::print("; {}", key.allowed);
    fmt::print("\n");
  }
}

void list_names(const std::vector<std::string>& names) {
  for (const std::string& name : names) fmt::print("{}\n", name);
}

void list_layouts() {
  for (const std::string& name : layout_names()) fmt::print("{}:\n{}\n", name, layout_table(name));
}

void list(const std::string& what, const std::string& study, const std::string& table) {
  if (!study.empty() && what != "simulators") {
    throw InputError("a study is for 'npdr list simulators STUDY'; leave it out");
  }
  if (!table.empty() && what != "keys" && what != "layouts") {
    throw InputError("--markdown is for 'npdr list keys' and 'npdr list layouts'; leave it out");
  }
  if (what == "simulators") return list_simulators(study);
  if (what == "keys") return table.empty() ? list_keys() : fmt::print("{}", keys_markdown(table));
  if (what == "layouts") {
    return table.empty() ? list_layouts() : fmt::print("{}", layout_table(table));
  }
  if (what == "methods") return list_names(names_of<inference::Algorithm>());
  if (what == "embeddings") return list_names(names_of<inference::EmbeddingKind>());
  if (what == "estimators") return list_names(names_of<inference::EstimatorKind>());
  if (what == "integrators") return list_names(names_of<sim::Integrator>());
  if (what == "metrics") return list_names(names_of<Metric>());
  if (what == "checks") return list_names(names_of<Check>());
  throw InputError(unknown_name("list", what,
                                {"simulators", "methods", "embeddings", "estimators", "integrators",
                                 "metrics", "checks", "keys", "layouts"}));
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

void add_validate_command(CLI::App& app, int& result) {
  auto* command =
      app.add_subcommand("validate", "check a study; print it resolved, and the work it implies");
  auto study = std::make_shared<StudyArguments>();
  auto quiet = std::make_shared<bool>(false);
  study->add_to(*command);
  command->add_flag("--quiet", *quiet, "don't print the resolved study");
  command->callback([&result, study, quiet] {
    result = guarded_main("npdr validate", [&] {
      const Plan plan = study->plan();
      if (!*quiet) print_json(to_json(plan.study));
      print_work(plan);
      print_warnings("npdr validate", plan);
      return ExitStatus::done;
    });
  });
}

void add_new_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand("new",
                                     "start a study: from a commented template, or for a "
                                     "simulator or recording of yours");
  auto wanted = std::make_shared<NewStudy>();
  command->add_option("NAME", wanted->name, "of the study; NAME.toml is written")->required();
  command->add_option("--recording", wanted->recording, "recorded rollouts (npdr import)");
  command->add_option("--simulator", wanted->simulator, "a built-in one (npdr list simulators)");
  command->add_option("--worker", wanted->worker, "program that stays: 'python3 sim.py'");
  command->add_option("--library", wanted->library, "shared library with npdr_simulator.h");
  command->add_option("--mjcf", wanted->mjcf, "model of MuJoCo");
  command->add_option("--command", wanted->command, "program that reads and writes files");
  command->footer("Example: npdr new spring --recording spring.h5 --worker 'python3 spring.py'");
  command->callback([&result, wanted] {
    result = guarded_main("npdr new", [&] {
      write_new_study(*wanted);
      return ExitStatus::done;
    });
  });
}

void add_list_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand("list", "what a study can choose from");
  auto what = std::make_shared<std::string>();
  auto study = std::make_shared<std::string>();
  auto table = std::make_shared<std::string>();
  command
      ->add_option("WHAT", *what,
                   "simulators, methods, embeddings, estimators, integrators, metrics, checks, "
                   "keys or layouts")
      ->required();
  command->add_option("STUDY", *study, "of simulators: show that of this study file");
  command->add_option("--markdown", *table,
                      "of keys or layouts: one table, such as method.training, as Markdown");
  command->callback([&result, what, study, table] {
    result = guarded_main("npdr list", [&] {
      list(*what, *study, *table);
      return ExitStatus::done;
    });
  });
}

}  // namespace npdr::pipeline
