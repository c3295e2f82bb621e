// The command that starts a study: from a template, or for a simulator or recording of the user's.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/printable.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/config/study_keys.h"
#include "pipeline/sources/marginal_fit.h"

namespace npdr::pipeline {
namespace {

// Options that name a simulator, of which a new study has one.
constexpr const char* kSimulatorOptions[] = {"simulator", "command", "worker",
                                             "library",   "mjcf",    "dataset"};

// Subject of a new study: the options of its command, "" those that weren't given.
struct NewStudy {
  std::string name;
  std::map<std::string, std::string> options;

  const std::string& of(const char* option) const { return options.at(option); }
  bool has(const char* option) const { return !of(option).empty(); }
};

// States of a rollout that are enough to tell parameters apart.
constexpr Index kStatesLeft = 50;
// More parameters than these are listed, but left out of the prior.
constexpr std::size_t kMostUnknown = 8;

// Basic strings of TOML are those of JSON.
std::string quoted_toml(const std::string& text) {
  try {
    return nlohmann::json(text).dump();
  } catch (const nlohmann::json::type_error&) {
    throw InputError(quoted(printable_line(text)) +
                     " isn't UTF-8, as studies must be; rename what is called so");
  }
}

std::string toml_list(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (const Channel& channel : channels) {
    names.push_back(quoted_toml(fmt::format("{} [{}]", channel.label, channel.unit)));
  }
  return "[" + join(names) + "]";
}

bool is_bare(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; }

// A name as a dotted key, the parts that need it in quotes.
std::string toml_key(const std::string& name) {
  std::vector<std::string> parts;
  for (const std::string& part : split(name, '.')) {
    const bool is_plain = !part.empty() && std::ranges::all_of(part, is_bare);
    parts.push_back(is_plain ? part : quoted_toml(part));
  }
  return join(parts, ".");
}

// A text that stays in its line.
std::string toml_comment(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; }, ' ');
  return text;
}

// Of a recording of several rollouts; asked for, since it takes longer than all before it.
constexpr const char* kRefined =
    "\n# No simulator is quite right: this method believes the recording only as far as that "
    "predicts\n# rollouts that are left out. It takes minutes to hours; where first states were "
    "measured like all\n# others, with infer_first_states = true behind cross_validate.\n"
    "# [[method]]\n# name = \"refined\"\n# algorithm = \"refine\"\n"
    "# refine = { start = \"NPE\", cross_validate = true }\n";

// A study whose reader refuses it helps nobody.
void require(const std::string& name, const std::string& value,
             const Constraint<std::string>& allowed) {
  if (!satisfies(value, allowed)) throw InputError(must_be(name, quoted(value), allowed.words));
}

// Sections of the text, one after the other.
class Writer {
 public:
  explicit Writer(const NewStudy& wanted) : wanted_(wanted) {
    if (wanted.has("recording")) recording_ = read_recording(wanted.of("recording"));
    find_simulator();
  }

  std::string text() {
    text_ = fmt::format(
        "# Check it with `npdr validate {0}.toml{1}`, run it with `npdr run {0}.toml`.\n"
        "# Lines with EDIT need you; docs/study-files.md explains every key.\n\n[study]\nname = "
        "\"{0}\"\n\n",
        wanted_.name, wanted_.has("dataset") ? "" : " --try 3");
    add_target();
    add_simulator();
    add_prior();
    add_method();
    return text_;
  }

 private:
  // A program says nothing of itself.
  bool is_program() const { return wanted_.has("command") || wanted_.has("worker"); }
  bool gives_motion() const { return (!wanted_.has("command") && !dataset_) || recording_; }

  void find_simulator() {
    Study study;
    study.simulator.name = wanted_.of("simulator");
    if (wanted_.has("library")) study.external.library = wanted_.of("library");
    if (wanted_.has("mjcf")) study.external.mjcf = wanted_.of("mjcf");
    study.external.folder = ".";
    if (wanted_.has("dataset")) {
      dataset_.emplace(wanted_.of("dataset"), std::vector<std::string>{});
      marginals_ = marginals_of(*dataset_);
    } else if (!is_program()) {
      const std::vector<std::string> known = sim::simulator_names();
      if (wanted_.has("simulator") && std::ranges::count(known, study.simulator.name) == 0) {
        throw InputError(unknown_name("simulator", study.simulator.name, known));
      }
      info_ = simulator_info(study);
    }
    if (!recording_) return;
    if (!is_program()) {
      read_recording(wanted_.of("recording"), channels_of(info_));
    } else {
      info_.state_channels = recording_->state_channels;
      info_.action_channels = recording_->action_channels;
    }
  }

  // What the parameters of all rows look drawn from.
  static std::vector<MarginalFit> marginals_of(const DatasetFile& dataset) {
    if (dataset.parameters().size() > kMostParameters) {
      throw InputError(fmt::format("the dataset has {} parameters, must have <= {}",
                                   dataset.parameters().size(), kMostParameters));
    }
    std::vector<MarginalFit> marginals(dataset.parameters().size());
    constexpr Index block = 4096;
    for (Index begin = 0; begin < dataset.num_rows(); begin += block) {
      std::vector<Index> rows(
          static_cast<std::size_t>(std::min(block, dataset.num_rows() - begin)));
      std::iota(rows.begin(), rows.end(), begin);
      const RowMatrix theta = dataset.theta(rows);
      for (std::size_t d = 0; d < marginals.size(); ++d) {
        marginals[d].observe(theta.col(static_cast<Index>(d)));
      }
    }
    return marginals;
  }

  void add_target() {
    text_ += "[target]\n";
    if (recording_) {
      text_ += fmt::format("recording = {}\n", quoted_toml(wanted_.of("recording")));
      if (recording_->num_rollouts() >= 3) {
        text_ += fmt::format(
            "num_rollouts = {}  # that inference sees\n"
            "held_out = 1  # that it doesn't, to predict; EDIT: 0 to use all\n",
            recording_->num_rollouts() - 1);
      }
    } else if (wanted_.has("observation")) {
      text_ += fmt::format("observation = {}\n", quoted_toml(wanted_.of("observation")));
    } else if (dataset_) {
      text_ += "observation = \"x_o.csv\"  # EDIT: the file of what was observed\n";
    } else if (is_program()) {
      text_ += fmt::format(
          "truth = {{ a = 1.0 }}  # EDIT: parameters of a simulated target, or in its place {}\n",
          gives_motion() ? "recording = \"FILE.h5\"" : "observation = \"x_o.csv\"");
    } else {
      text_ += "truth = {}  # the nominal parameters; recording = \"FILE.h5\" takes its place\n";
    }
    text_ += "\n";
  }

  void add_simulator() {
    text_ += "[simulator]\n";
    for (const std::string option : kSimulatorOptions) {
      const std::string& value = wanted_.options.at(option);
      if (value.empty()) continue;
      text_ +=
          fmt::format("{} = {}\n", option == "simulator" ? "name" : option, quoted_toml(value));
    }
    const bool is_own = !wanted_.has("simulator");
    if (is_program() && gives_motion()) {
      const char* const mark = recording_ ? "" : "  # EDIT";
      const auto states = recording_ ? info_.state_channels : std::vector<Channel>{{"q", "rad"}};
      text_ += fmt::format("states = {}{}\nactions = {}{}\n", toml_list(states), mark,
                           toml_list(info_.action_channels), mark);
    } else if (is_program() && !wanted_.has("observation")) {
      text_ += "features = [\"x0\", \"x1\"]  # EDIT: what the command writes\n";
    }
    if (is_own && gives_motion() && !recording_) {
      const std::vector<std::string> zeros(std::max<std::size_t>(1, info_.state_channels.size()),
                                           "0.1");
      text_ += fmt::format(
          "dt = 0.02  # EDIT: [s]\nnum_steps = 250\n"
          "initial_states = [[{}]]  # EDIT: a list for each rollout\n",
          join(zeros));
    }
    if (gives_motion() && recording_) {
      text_ +=
          "# Restart from the recorded state after so many steps where errors grow with time:\n"
          "# segment_length = 50\n";
    }
    if (is_program() && !wanted_.has("observation")) {
      text_ +=
          "\n# EDIT: one for each domain parameter that the program knows\n"
          "[[simulator.parameter]]\nname = \"a\"\nunit = \"1\"\nnominal = 1.0\n";
    }
    text_ += "\n";
  }

  // Half to one and a half of the nominal value, inside of the limits; what is nothing at nominal
  // says nothing of its size.
  static std::string marginal(const sim::Parameter& p) {
    double low = p.nominal - 0.5 * std::abs(p.nominal),
           high = p.nominal + 0.5 * std::abs(p.nominal);
    if (p.nominal == 0.0) (p.upper > 0.0 ? high : low) = p.upper > 0.0 ? 1.0 : -1.0;
    low = std::clamp(low, p.lower, p.upper);
    high = std::clamp(high, p.lower, p.upper);
    return fmt::format("{{ uniform = [{}, {}] }}", number(low), number(high));
  }

  // A float of TOML: of six digits, or of all.
  static std::string number(double value) { return as_float(fmt::format("{:.6g}", value)); }
  static std::string exact(double value) { return as_float(fmt::format("{}", value)); }
  static std::string as_float(const std::string& text) {
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  }

  void add_prior_of_dataset() {
    text_ +=
        "# EDIT: what theta was drawn from; here what its values look like, of uniform,\n"
        "# log_uniform, normal and log_normal, with bounds half of a step between values further "
        "out.\n[prior]\n";
    for (std::size_t d = 0; d < marginals_.size(); ++d) {
      const auto& [name, unit] = dataset_->parameters()[d];
      require("a parameter of the dataset", name, column_name());
      const bool is_constant = marginals_[d].is_constant();
      const inference::Marginal fit = marginals_[d].likeliest();
      const auto number_of = [&](double v) { return fit.is_uniform() ? exact(v) : number(v); };
      text_ += fmt::format("{}{} = {{ {} = [{}, {}] }}  # [{}]{}\n", is_constant ? "# " : "",
                           toml_key(name), name_of(fit.kind), number_of(fit.a), number_of(fit.b),
                           toml_comment(unit), is_constant ? " the same in all rows" : "");
    }
    text_ += "\n";
  }

  void add_prior() {
    if (dataset_) return add_prior_of_dataset();
    text_ +=
        "# What to infer, in the parameters' units; the rest stay nominal. EDIT: as wide as what "
        "you\n"
        "# don't know.\n[prior]\n";
    if (is_program()) {
      text_ +=
          "a = { uniform = [0.5, 1.5] }\n\n"
          "# Simulations that are kept together, so that an interrupted run loses no more: fewer "
          "where\n# each takes long. Results don't depend on it.\n[simulate]\nshard_size = 200\n\n";
      return;
    }
    for (std::size_t i = 0; i < info_.parameters.size(); ++i) {
      const sim::Parameter& p = info_.parameters[i];
      const bool is_left_out = i >= kMostUnknown || p.nominal == 0.0;
      text_ += fmt::format("{}{} = {}  # [{}] {}\n", is_left_out ? "# " : "", toml_key(p.name),
                           marginal(p), toml_comment(p.unit), toml_comment(p.description));
    }
    text_ += "\n";
  }

  // A recording is off by what its simulator lacks, too, which nobody knows beforehand. Features
  // have the noise of their program.
  void add_noise() {
    text_ +=
        "# Noise on what is simulated, as a share of each channel's largest value: what a "
        "recording has\n# and no simulation does.";
    text_ += recording_ ? " How much is inferred, [median, deviation of the log] before that; "
                          "EDIT:\n# scale = 0.02 where sensors tell, and the simulator is right."
                          "\n[observation_noise]\nscale_prior = [0.1, 1.0]\n\n"
                        : " EDIT: that of your sensors.\n[observation_noise]\nscale = 0.02\n\n";
  }

  void add_method() {
    if (gives_motion()) add_noise();
    text_ += fmt::format("[[method]]\nname = \"NPE\"\nnum_simulations = {}\n",
                         dataset_ ? dataset_->num_rows() : Index{3000});
    if (!gives_motion()) return;
    const Index steps =
        recording_ ? recording_->num_steps() : std::max<Index>(info_.num_steps, Index{250});
    text_ +=
        fmt::format("embedding = {{ downsample = {} }}\n", std::max<Index>(1, steps / kStatesLeft));
    if (recording_ && recording_->num_rollouts() > 1) text_ += kRefined;
  }

  NewStudy wanted_;
  std::optional<Target> recording_;
  std::optional<DatasetFile> dataset_;
  sim::SimulatorInfo info_;
  std::vector<MarginalFit> marginals_;  // of the dataset
  std::string text_;
};

// Channels of the recording, parameters of the simulator with a prior around their nominal values,
// those of a dataset with one over their ranges, an embedding of all steps. What only the user can
// know is marked with `EDIT`.
std::string new_study_text(const NewStudy& wanted) {
  require("study.name", wanted.name, folder_name());
  std::vector<std::string> found;
  for (const std::string option : kSimulatorOptions) {
    const std::string& value = wanted.options.at(option);
    if (value.empty()) continue;
    const bool is_program = option == "command" || option == "worker";
    found.push_back("--" + option);
    require(found.back(), value, is_program ? shell_command() : file_path());
  }
  if (wanted.has("dataset") && wanted.has("recording")) {
    throw InputError("--dataset can't go with --recording: a dataset has features of its own");
  }
  if (wanted.has("recording")) require("--recording", wanted.of("recording"), file_path());
  if (wanted.has("observation")) {
    require("--observation", wanted.of("observation"), file_path());
    if (wanted.has("recording") || (!wanted.has("command") && !wanted.has("dataset"))) {
      throw InputError(
          "--observation goes with --command or --dataset, which give numbers x; of motion there "
          "is a --recording");
    }
    read_observation(wanted.of("observation"), {});
  }
  if (found.size() != 1) {
    throw InputError(found.empty() ? "--recording needs one of --simulator, --worker, --library, "
                                     "--mjcf and --command beside it"
                                   : join(found, " and ") + " can't go together; give one of them");
  }
  return Writer(wanted).text();
}

void write_new_study(NewStudy wanted) {
  if (wanted.name.ends_with(".toml")) wanted.name.resize(wanted.name.size() - 5);
  const std::filesystem::path path = wanted.name + ".toml";
  const bool is_specific = std::ranges::any_of(
      wanted.options, [](const auto& option) { return !option.second.empty(); });
  const std::string text = is_specific ? new_study_text(wanted) : study_template(wanted.name);
  if (std::filesystem::exists(path)) {
    throw InputError(path.string() + ": is there already; choose another name or remove it");
  }
  write_text_file(path, text);
  const bool needs_edits = text.find("EDIT") != std::string::npos;
  fmt::print("wrote {0}; {1}run it with: npdr run {0}\n", path.string(),
             needs_edits ? "edit the lines with EDIT, then " : "");
}

}  // namespace

Action new_command(CLI::App& command) {
  auto wanted = std::make_shared<NewStudy>();
  command.add_option("NAME", wanted->name, "of the study; NAME.toml is written")->required();
  const auto add = [&](const std::string& option, const char* doc) {
    command.add_option("--" + option, wanted->options[option], doc);
  };
  add("recording", "recorded rollouts (npdr import)");
  add("observation", "x_o: CSV with one row, or HDF5");
  add("simulator", "a built-in one (npdr list simulators)");
  add("worker", "program that stays: 'python3 sim.py'");
  add("library", "shared library with npdr_simulator.h");
  add("mjcf", "model of MuJoCo");
  add("dataset", "finished simulations (npdr import --theta)");
  add("command", "program that reads and writes files");
  command.footer(
      "Examples:\n  npdr new spring --recording spring.h5 --worker 'python3 spring.py'\n"
      "  npdr new counts --observation x_o.csv --command 'python3 counts.py {theta} {x}'");
  return done_after([wanted] { write_new_study(*wanted); });
}

}  // namespace npdr::pipeline
