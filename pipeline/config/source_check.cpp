#include "pipeline/config/study_check.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>

#include "core/constants.h"
#include "core/feature_names.h"
#include "inference/embeddings/embedding_config.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {
namespace {

class SourceChecker : Checker {
 public:
  SourceChecker(const Study& study, const sim::SimulatorInfo* info, Reading& reading)
      : Checker(study, info, reading), source_(study.source()), what_(source_.name) {}

  void check() {
    const ExternalConfig& external = study_.external;
    must_be_left_out(unused_fields(fields_of(SimulatorTable{study_.simulator, external}),  //
                                   "simulator"));
    if (source_.runs_users_code()) {
      for (const std::string& name : external.files) {
        const std::filesystem::path path = std::filesystem::path(external.folder) / name;
        require_file("simulator.files", path.string(), "existing files");
      }
    }
    source_.gives_motion ? check_motion() : check_features();
    if (source_.calls_program) check_program();
    if (!source_.simulates) check_dataset();
    if (external.library) require_file("simulator.library", *external.library, "an existing file");
    if (external.mjcf) require_file("simulator.mjcf", *external.mjcf, "an existing file");
    if (!source_.describes_itself) check_parameters();
  }

 private:
  void check_parameters() {
    const auto& parameters = study_.external.parameters;
    std::set<std::string> names;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const std::string path = fmt::format("simulator.parameter[{}]", i);
      const DescribedParameter& p = parameters[i];
      const double nominal = p.nominal.value_or(0.0), lower = p.lower.value_or(-kInfinity),
                   upper = p.upper.value_or(kInfinity);
      require(path + ".name", p.name, names.insert(p.name).second, "there once");
      require(path + ".lower", lower, lower < upper, fmt::format("< upper = {}", upper));
      require(path + ".nominal", nominal, !p.nominal || (nominal >= lower && nominal <= upper),
              "in the parameter's limits");
      const bool is_in_prior =
          std::ranges::count(study_.prior, p.name, &inference::Marginal::name) > 0;
      if (p.nominal || is_in_prior || study_.simulator.parameters.contains(p.name)) continue;
      fail(path + ".nominal",
           fmt::format("{} of '{}' is missing, must be a number: neither [prior] nor "
                       "simulator.parameters has the parameter",
                       display(path + ".nominal"), p.name));
    }
  }

  // Labels of channels, or of features, which differ. In CSV files they head columns.
  void check_labels(const char* path, const std::vector<std::string>& names, bool are_columns) {
    std::set<std::string> labels;
    for (const std::string& name : names) {
      const std::string label = parse_feature(name).label;
      if (label.empty() || !labels.insert(label).second) {
        reading_.reject(path, quoted(name), "distinct labels, such as \"theta [rad]\"");
      } else if (are_columns && !satisfies(label, column_name())) {
        reading_.reject(path, quoted(name), column_name().words);
      } else if (source_.gives_motion && are_columns && (label == "steps" || label == "past")) {
        reading_.reject(path, quoted(name),
                        "another name: a file of segments has a column of this one");
      }
    }
  }

  // So do parameters.
  void check_parameter_names() {
    const auto check_name = [&](const std::string& table, const std::string& name) {
      if (satisfies(name, column_name())) return;
      fail(table + "." + name,
           fmt::format("{}: the name {} must be {}", table, quoted(name), column_name().words));
    };
    for (const inference::Marginal& marginal : study_.prior) check_name("prior", marginal.name);
    for (const auto& [name, value] : study_.simulator.parameters) {
      check_name("simulator.parameters", name);
    }
  }

  // How a truth's rollouts begin, and how long they are.
  void check_truths_beginning() {
    const ExternalConfig& external = study_.external;
    if (!study_.target.truth || study_.target.inputs) {
      return must_be_left_out(
          {"simulator.dt", "simulator.num_steps", "simulator.initial_states"},
          study_.target.truth ? "target.inputs says it" : "the recording says it");
    }
    const std::string why =
        ": a truth has no recording to take it from; target.inputs = "
        "\"recording.h5\" may take its place";
    require_there("simulator.dt", std::isnormal(external.dt), "a time in seconds" + why);
    require_there("simulator.num_steps", external.num_steps >= 1, ">= 1" + why);
    require_there("simulator.initial_states", !external.initial_states.empty(),
                  "a list of states, such as [[0.1, 0.0], [0.2, 0.0]]" + why);
    if (source_.describes_itself) return;  // how many states that is, is known when it is loaded
    for (const std::vector<double>& state : external.initial_states) {
      if (state.size() == external.states.size()) continue;
      reading_.reject(
          "simulator.initial_states", counted(std::ssize(state), "number"),
          fmt::format("lists of {}, one for each of simulator.states", external.states.size()));
    }
  }

  void check_motion() {
    const ExternalConfig& external = study_.external;
    must_be_left_out({"target.observation"}, "it is for a simulator.command or dataset");
    if (!source_.is_built_in) {
      check_labels("simulator.states", external.states, external.command.has_value());
      check_labels("simulator.actions", external.actions, external.command.has_value());
      require_there("simulator.states", !external.worker || !external.states.empty(),
                    "the state channels that the worker returns, such as [\"q [m]\", \"v [m/s]\"]");
      check_truths_beginning();
    }
    if (external.command) check_parameter_names();
    if (!source_.describes_itself) check_nominal_values();
    if (std::ranges::count(study_.evaluate.metrics, Metric::distance) > 0) {
      reading_.reject("evaluate.metrics", quoted(name_of(Metric::distance)),
                      "left out: it is for a simulator.command");
    }
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      const inference::EmbeddingKind kind = study_.methods[i].embedding.kind;
      require(method_path(i) + ".embedding.kind", kind, kind != inference::EmbeddingKind::identity,
              "another: it is for a simulator.command or dataset; 'all_steps' keeps all states");
    }
  }

  void check_features() {
    must_be_left_out({"target.recording", "target.inputs", "target.rollouts", "target.num_rollouts",
                      "target.held_out", "evaluate.leave_out"},
                     no_rollouts());
    must_be_left_out({"evaluate.floor"}, "nothing is fitted with a " + what_);
    if (!source_.simulates || study_.evaluate.metrics != std::vector{Metric::distance}) {
      must_be_left_out({"evaluate.metrics"}, no_rollouts());
    }
    check_labels("simulator.features", study_.external.features, true);
    check_parameter_names();
    check_target();
    check_nominal_values();
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      check_method(method_path(i), study_.methods[i]);
    }
  }

  // Without nominal values, whoever names parameters must name all of the prior.
  void check_nominal_values() {
    if (study_.target.truth) check_complete("target.truth", *study_.target.truth);
    for (std::size_t i = 0; i < study_.references.size(); ++i) {
      check_complete(fmt::format("reference[{}].parameters", i), study_.references[i].parameters);
    }
  }

  void check_complete(const std::string& path, const std::map<std::string, double>& values) {
    for (const inference::Marginal& marginal : study_.prior) {
      const auto& described = study_.external.parameters;
      const auto known = std::ranges::find(described, marginal.name, &DescribedParameter::name);
      if (!described.empty() && known == described.end()) continue;  // it is unknown, and told so
      const bool has_nominal = known != described.end() && known->nominal;
      if (has_nominal || values.contains(marginal.name)) continue;
      fail(path, fmt::format("{}: '{}' is missing: a {} has no nominal values", display(path),
                             marginal.name, what_));
    }
  }

  void check_target() {
    const std::optional<std::string>& observation = study_.target.observation;
    const bool has_truth = study_.target.truth.has_value();
    if (!reading_.good("target.observation") || !reading_.good("target.truth") ||
        !require_one_of("target", observation.has_value(), "observation = \"x_o.csv\"", has_truth,
                        "truth = { parameter = value }")) {
      return;
    }
    if (observation) {
      must_be_left_out({"target.seed"}, "it picks the random behavior of a truth");
      require_file("target.observation", *observation, "an existing CSV or HDF5 file");
    } else {
      require_there("simulator.features", !study_.external.features.empty() || !source_.simulates,
                    "the names of what x holds: with a truth there is no file of x_o to take them "
                    "from");
    }
  }

  void check_method(const std::string& path, const MethodConfig& method) {
    must_be_left_out({path + ".num_rollouts", path + ".embedding.downsample"}, no_rollouts());
    using enum inference::EmbeddingKind;
    const auto& [kind, shape] = std::tie(method.embedding.kind, method.embedding.shape);
    if (shape.empty()) must_be_left_out({path + ".embedding.features"}, no_rollouts());
    require(path + ".embedding.kind", kind, kind == (shape.empty() ? identity : convolution),
            shape.empty() ? "'identity', or 'convolution' with embedding.shape: " + no_rollouts()
                          : "'convolution', as embedding.shape is given");
    const Index rounds = method.algorithm.num_rounds;
    require(path + ".num_rounds", rounds, source_.simulates || rounds == 1,
            "1 with a dataset: nothing simulates what later rounds propose");
  }

  void check_program() {
    const ExternalConfig& external = study_.external;
    std::error_code unreadable;
    if (!std::filesystem::is_directory(external.folder, unreadable)) {
      return reading_.reject("simulator.folder", quoted(external.folder), "an existing folder");
    }
    const std::string& command = external.worker ? *external.worker : *external.command;
    const std::string fault = program_fault(command, external.folder);
    if (fault.empty()) return;
    reading_.reject("simulator." + what_, quoted(command), "a command that can be run: " + fault);
  }

  void check_dataset() {
    must_be_left_out({"simulator.parameters", "target.truth", "target.seed"},
                     "a dataset can't be simulated again");
    require_file("simulator.dataset", *study_.external.dataset,
                 "an existing HDF5 file; 'npdr import --theta' makes one of CSV files");
  }

  std::string no_rollouts() const { return "a " + what_ + " gives no rollouts"; }

  const SourceTraits& source_;
  std::string what_;
};

// Those of the keys that say where rows come from that the study has.
std::vector<std::string> sources_of(const Study& study, const Reading& reading) {
  std::vector<std::string> found(kSourceKeys.begin(), kSourceKeys.end());
  std::erase_if(found, [&](const std::string& key) {
    return !reading.has("simulator." + key) || (key == "name" && study.simulator.name.empty());
  });
  return found;
}

}  // namespace

bool has_source(const Study& study, const Reading& reading) {
  for (const char* source : kSourceKeys) {
    if (!reading.good(std::string("simulator.") + source)) return false;
  }
  return sources_of(study, reading).size() == 1;
}

void check_source(const Study& study, const sim::SimulatorInfo* info, Reading& reading) {
  if (has_source(study, reading)) return SourceChecker(study, info, reading).check();
  if (!reading.good("simulator")) return;
  const std::vector<std::string> found = sources_of(study, reading);
  if (found.empty()) {
    reading.fail("simulator.name",
                 "simulator.name is missing, must be text, one of " + join(sim::simulator_names()) +
                     "; a command, worker, library, mjcf or dataset may take its place");
  } else {
    reading.fail("simulator." + found.back(),
                 "simulator has " + join(found, " and ") + ", must have one of them");
  }
}

void check_dataset_rows(const Study& study, Index num_rows) {
  Reading reading(study.places);
  for (std::size_t i = 0; i < study.methods.size(); ++i) {
    const Index wanted = study.methods[i].algorithm.num_simulations;
    if (wanted <= num_rows) continue;
    reading.reject(fmt::format("method[{}].num_simulations", i), std::to_string(wanted),
                   fmt::format("<= {}, the rows of the dataset", num_rows));
  }
  if (num_rows > std::numeric_limits<std::uint32_t>::max()) {
    reading.reject("simulator.dataset", std::to_string(num_rows) + " rows", "of < 2^32 rows");
  }
  reading.throw_if_bad();
}

void take_units(Study& study, const std::vector<Channel>& parameters) {
  const auto has_unit = [](const Channel& parameter) { return parameter.unit != "1"; };
  if (std::ranges::none_of(parameters, has_unit)) return;
  Reading reading(study.places);
  std::vector<DescribedParameter>& described = study.external.parameters;
  const bool are_described = !described.empty();
  const Constraint<std::string> allowed = label();
  for (std::size_t d = 0; d < parameters.size(); ++d) {
    const auto& [name, unit] = parameters[d];
    if (!are_described) described.push_back({.name = name});
    const auto known = std::ranges::find(described, name, &DescribedParameter::name);
    if (!has_unit(parameters[d]) || known == described.end()) continue;
    const std::string path = fmt::format("simulator.parameter[{}].unit", known - described.begin());
    const std::string stated = known->unit;
    if (!satisfies(unit, allowed)) {
      reading.reject("simulator.dataset", fmt::format("with '{}' in {}", name, quoted(unit)),
                     "with units that are " + allowed.words);
      continue;
    }
    if (study.places.has(path) && stated != unit) {
      reading.reject(path, quoted(stated), quoted(unit) + ", as in the dataset");
    }
    known->unit = unit;
    study.prior[d].unit = unit;
  }
  reading.throw_if_bad();
}

}  // namespace npdr::pipeline
