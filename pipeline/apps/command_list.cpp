// The command that lists what a study can choose from.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/name_words.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/config/study_keys.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {
namespace {

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
  Study study = read_study(file, {});
  resolve_source(study);
  const auto source = make_source(study);
  const sim::SimulatorInfo& info = source->info();
  fmt::print("{}{}{}\nparameters:\n", info.name, info.description.empty() ? "" : ": ",
             info.description);
  for (const sim::Parameter& p : info.parameters) {
    const std::string nominal = std::isnan(p.nominal) ? "none" : fmt::format("{:.6g}", p.nominal);
    fmt::print("    {:<24} {:>10} {:<12} {:<16} {}\n", p.name, nominal, p.unit, limits_text(p),
               p.description);
  }
  const auto list_channels = [](const char* title, const std::vector<Channel>& channels) {
    if (!channels.empty()) fmt::print("{}:\n", title);
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

struct ListArguments {
  std::string what;
  std::string of;     ///< a study of simulators, a beginning of keys
  std::string table;  ///< --markdown
};

void list_keys(const ListArguments& arguments) {
  if (!arguments.table.empty()) return fmt::print("{}", keys_markdown(arguments.table));
  std::vector<StudyKey> keys = study_keys();
  std::erase_if(keys, [&](const StudyKey& key) { return !key.path.starts_with(arguments.of); });
  if (keys.empty()) {
    std::vector<std::string> tables;
    for (const StudyTable& table : study_tables()) tables.push_back(table.path);
    throw InputError(unknown_name("beginning of a key", arguments.of, tables));
  }
  for (const StudyKey& key : keys) {
    fmt::print("{:<44} {}", key.path, key.doc);
    if (!key.default_value.empty()) fmt::print("; default {}", key.default_value);
    if (!key.allowed.empty()) fmt::print("; {}", key.allowed);
    fmt::print("\n");
  }
}

template <NamedEnum E>
void list_names(const ListArguments&) {
  for (const auto& row : enum_table(E{})) {
    if (!row.name.empty()) fmt::print("{:<18} {}\n", row.name, words_of(row.value));
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

void list_lists() {
  for (const List& list : kLists) {
    const std::string name =
        std::string(list.name) + (list.of ? fmt::format(" [{}]", list.of) : "");
    fmt::print("npdr list {:<20} {}\n", name, list.doc);
  }
}

void list(const ListArguments& arguments) {
  if (arguments.what.empty()) return list_lists();
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
  return [arguments] {
    list(*arguments);
    return ExitStatus::done;
  };
}

}  // namespace npdr::pipeline
