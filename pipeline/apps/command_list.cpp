// The command that lists what a study can choose from.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "core/text.h"
#include "inference/algorithms/algorithm_config.h"
#include "inference/embeddings/embedding_config.h"
#include "inference/estimators/estimator_config.h"
#include "inference/prior.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/layout.h"
#include "pipeline/config/check.h"
#include "pipeline/config/metric.h"
#include "pipeline/config/study_keys.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/sources/source.h"
#include "sim/integrator.h"

namespace npdr::pipeline {
namespace {

// A line about each name that studies choose from; checks and estimators have words of their own.
const std::map<std::string_view, const char*> kWords = {
    // algorithms
    {"npe_nle",
     "networks learn the posterior and the likelihood, pooled by what predicts best; the "
     "usual choice; later rounds simulate the prior where the posterior is"},
    {"npe_a", "a mixture learns the posterior; later rounds are divided by their proposal"},
    {"npe_b",
     "a network learns the posterior; later rounds weight simulations by prior / proposal"},
    {"npe_c", "a network learns the posterior; later rounds simulate draws of the posterior"},
    {"nle", "a network learns the likelihood, which a sampler makes a posterior of"},
    {"nre_a", "a classifier learns likelihood / evidence: pairs that belong together or don't"},
    {"nre_b", "the same, of one pair among several"},
    {"abc_rejection", "simulations of the prior whose distance to the observation is small"},
    {"abc_mcmc", "the same by Markov chains"},
    {"abc_smc", "the same by populations that come nearer from round to round"},
    {"linear_regression",
     "the equations of motion as a Bayesian regression on the recording, no simulation"},
    {"least_squares", "the best fit from many starts, robust, with error bars by its curvature"},
    {"refine",
     "the posterior under the noise's likelihood, from another method's, with its evidence"},
    {"prior", "infers nothing: domain randomization over the prior"},
    {"nominal", "infers nothing: the nominal parameters"},
    // embeddings
    {"convolution",
     "the states of all kept steps through convolutions that are trained with the network"},
    {"linear", "the states of all kept steps through a layer that is trained with the network"},
    {"all_steps", "the states of all kept steps"},
    {"delta_steps", "their differences from step to step"},
    {"last_step", "the last states alone"},
    {"bayessim", "sums over each series: short, and blind to much of it"},
    {"identity", "the features as the simulator gives them"},
    // priors
    {"uniform", "[low, high]: every value between is as likely"},
    {"log_uniform", "[low, high] with low > 0: every order of magnitude is as likely"},
    {"normal", "[mean, standard deviation]; lower = and upper = cut this and the next three off"},
    {"log_normal", "[mean of log, standard deviation of log]: positive"},
    {"gamma", "[shape, scale]: positive, of mean shape * scale; shape 1: exponential"},
    {"beta", "[a, b]: between 0 and 1, of mean a / (a + b)"},
    // integrators
    {"erk4", "Runge-Kutta of order 4 with fixed steps"},
    {"erk2", "of order 2"},
    {"erk5", "of order 5"},
    {"cvode", "steps and orders that adapt to tolerances, for stiff systems"},
    // metrics
    {"dtw", "distance of trajectories that may be shifted in time (dynamic time warping)"},
    {"rmse", "root mean square error of the states, over their largest recorded magnitude"},
    {"final_error", "distance of the last states, where all have one unit"},
    {"goal", "share of the rollouts that end at the simulator's goal"},
    {"distance", "of features, in standard deviations over the prior"}};

std::string_view words_of(const auto& row) { return kWords.at(row.name); }
std::string_view words_of(const CheckTraits& row) { return row.question; }
std::string words_of(const inference::EstimatorTraits& row) {
  return fmt::format("{}{}", row.title, row.words);
}

void list_channels(const char* title, const std::vector<Channel>& channels) {
  if (!channels.empty()) fmt::print("{}:\n", title);
  for (const Channel& channel : channels) {
    fmt::print("    {:<24} {:>10} {}\n", channel.label, "", channel.unit);
  }
}

void list_simulator(const sim::SimulatorInfo& info, bool gives_motion = true) {
  fmt::print("{}{}{}\nparameters:\n", info.name, info.description.empty() ? "" : ": ",
             info.description);
  for (const sim::Parameter& p : info.parameters) {
    const std::string nominal = std::isnan(p.nominal) ? "none" : fmt::format("{:.6g}", p.nominal);
    const bool is_limited = std::isfinite(p.lower) || std::isfinite(p.upper);
    fmt::print("    {:<24} {:>10} {:<12} {:<16} {}\n", p.name, nominal, p.unit,
               is_limited ? fmt::format("[{:g}, {:g}]", p.lower, p.upper) : "", p.description);
  }
  list_channels(gives_motion ? "states" : "features", info.state_channels);
  if (gives_motion) list_channels("actions", info.action_channels);
  if (info.goal) fmt::print("goal: {}\n", info.goal->description);
}

void list_simulators(const std::string& file) {
  if (!file.empty()) {
    Study study = read_study(file, {});
    resolve_source(study);
    return list_simulator(make_source(study)->info(), study.source().gives_motion);
  }
  for (const std::string& name : sim::simulator_names()) {
    sim::SimulatorConfig config;
    config.name = name;
    list_simulator(sim::make_simulator(config)->info());
  }
}

struct ListArguments {
  std::string what;
  std::string of;     ///< a study of simulators, a beginning of keys
  std::string table;  ///< --markdown
};

void list_keys(const ListArguments& arguments) {
  if (!arguments.table.empty()) return fmt::print("{}", keys_markdown(arguments.table));
  Fields keys = study_keys();
  std::erase_if(keys, [&](const Field& key) { return !key.path.starts_with(arguments.of); });
  if (keys.empty()) {
    throw InputError(unknown_name("beginning of a key", arguments.of, study_tables()));
  }
  for (const Field& key : keys) {
    fmt::print("{:<44} {}", key.path, key.doc);
    const std::string value = default_text(key);
    if (!value.empty()) fmt::print("; default {}", value);
    if (!key.allowed.empty()) fmt::print("; {}", key.allowed);
    fmt::print("\n");
  }
}

template <NamedEnum E>
void list_names(const ListArguments&) {
  for (const auto& row : enum_table(E{})) {
    if (!row.name.empty()) fmt::print("{:<18} {}\n", row.name, words_of(row));
  }
}

void list_layouts(const ListArguments& arguments) {
  if (!arguments.table.empty()) return fmt::print("{}", layout_table(arguments.table));
  for (const std::string& name : layout_names()) fmt::print("{}:\n{}\n", name, layout_table(name));
}

struct List {
  std::string_view name;
  const char* doc;
  void (*print)(const ListArguments&);
  const char* of = nullptr;  ///< what a second word is; null: there is none
  bool has_tables = false;   ///< --markdown
};

constexpr List kLists[] = {
    {"simulators", "built-in ones with their parameters; with a study that of the study",
     [](const ListArguments& arguments) { list_simulators(arguments.of); }, "STUDY"},
    {"methods", "algorithms: method.algorithm", &list_names<inference::Algorithm>},
    {"embeddings", "what inference sees: method.embedding.kind",
     &list_names<inference::EmbeddingKind>},
    {"estimators", "networks: method.density_estimator.kind",
     &list_names<inference::EstimatorKind>},
    {"priors", "kinds of a parameter's prior", &list_names<inference::Marginal::Kind>},
    {"integrators", "of built-in simulators: simulator.integrator", &list_names<sim::Integrator>},
    {"metrics", "what simulations are measured by: evaluate.metrics", &list_names<Metric>},
    {"checks", "what posteriors are checked by: diagnose.checks", &list_names<Check>},
    {"keys", "every key of a study file; with a beginning, such as method.training, those",
     &list_keys, "BEGINNING", true},
    {"layouts", "what every file of results holds", &list_layouts, nullptr, true},
};

std::vector<std::string> list_names() {
  std::vector<std::string> names;
  for (const List& list : kLists) names.emplace_back(list.name);
  return names;
}

void list(const ListArguments& arguments) {
  if (arguments.what.empty()) {
    for (const List& list : kLists) {
      const std::string of = list.of ? fmt::format(" [{}]", list.of) : "";
      fmt::print("npdr list {:<20} {}\n", std::string(list.name) + of, list.doc);
    }
    return;
  }
  const auto found = std::ranges::find(kLists, arguments.what, &List::name);
  if (found == std::end(kLists)) {
    throw InputError(unknown_name("list", arguments.what, list_names()));
  }
  if (!arguments.of.empty() && found->of == nullptr) {
    throw InputError(fmt::format("'{}': 'npdr list {}' takes no second word; leave it out",
                                 arguments.of, arguments.what));
  }
  if (!arguments.table.empty() && !found->has_tables) {
    throw InputError("--markdown is for 'npdr list keys' and 'npdr list layouts'; leave it out");
  }
  found->print(arguments);
}

}  // namespace

Action list_command(CLI::App& command) {
  auto arguments = std::make_shared<ListArguments>();
  set_choices(*command.add_option("WHAT", arguments->what, "what to list; nothing: the lists"),
              list_names());
  command.add_option("OF", arguments->of,
                     "of simulators: a study file, whose is shown; of keys: their beginning");
  command.add_option("--markdown", arguments->table,
                     "of keys or layouts: one table, such as method.training, as Markdown");
  command.footer("Examples:\n  npdr list methods\n  npdr list keys method.training");
  return done_after([arguments] { list(*arguments); });
}

}  // namespace npdr::pipeline
