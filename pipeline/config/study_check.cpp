#include "pipeline/config/study_check.h"

#include <optional>
#include <set>

#include "analysis/latex_symbols.h"
#include "analysis/pair_plot.h"
#include "core/error.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "pipeline/config/check.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/cluster_check.h"
#include "pipeline/config/part_checks.h"
#include "pipeline/config/prior_check.h"
#include "pipeline/config/rollout_check.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/config/source_check.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;
using Numbers = std::map<std::string, double>;

constexpr const char* kRecordingFile =
    "an existing HDF5 file; 'npdr import' makes one of CSV files";

class StudyChecker : Checker {
 public:
  StudyChecker(Study& study, Reading& reading) : Checker(reading), study_(study) {}

  void check() {
    check_source(study_, reading_);
    load_simulator();
    const sim::SimulatorInfo* const info = info_ ? &*info_ : nullptr;
    check_source_settings(study_, reading_);
    check_noise(study_, info, reading_);
    check_target();
    check_values("simulator.parameters", study_.simulator.parameters);
    for (Marginal& marginal : study_.prior) check_marginal(marginal);
    check_method_names();
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      check_method(study_, i, info, reading_);
    }
    check_diagnose();
    check_references();
    check_goal();
    check_metrics();
    check_held_out();
    check_report();
    check_policy(study_, info, reading_);
    check_cluster(study_, reading_);
    check_truths_rollouts();
    check_simulator();
  }

 private:
  // Needs nothing but the name; the other checks need what it finds.
  void load_simulator() {
    if (!has_source(study_, reading_)) return;
    try {
      info_ = simulator_info(study_);
    } catch (const InputError& error) {  // of a library, or a model of MuJoCo
      reading_.fail(study_.external.mjcf ? "simulator.mjcf" : "simulator.library", error.what());
    }
  }

  // The simulator has the last word on its settings; its message has no position.
  void check_simulator() {
    if (!reading_.problems().empty() || !study_.source().is_built_in) return;
    try {
      sim::make_simulator(study_.simulator);
    } catch (const InputError& error) {
      reading_.fail("simulator", error.what());
    }
  }

  void check_target() {
    const TargetConfig& target = study_.target;
    if (!study_.source().gives_motion) {
      if (target.truth) check_values("target.truth", *target.truth);
      return;
    }
    const bool readable = reading_.good("target.recording") && reading_.good("target.truth");
    if (readable && target.recording.has_value() == target.truth.has_value()) {
      return reading_.fail(
          "target", fmt::format("target has {} recording = \"file.h5\" {} truth = {{ parameter = "
                                "value }}, must have one of them",
                                target.truth ? "both" : "neither", target.truth ? "and" : "nor"));
    }
    if (target.recording) check_recorded(*target.recording);
    if (!target.truth) return must_be_left_out("target.inputs", "it is for a truth");
    if (target.inputs) require_file("target.inputs", *target.inputs, kRecordingFile);
    must_be_left_out("target.rollouts", "it picks those of a recording");
    check_values("target.truth", *target.truth);
    if (target.num_rollouts < 1 && !target.inputs) {
      fail("target.num_rollouts", "0", ">= 1 with a truth: there is no recording to take all of");
    }
  }

  void check_recorded(const std::string& recording) {
    if (recording.ends_with(".csv")) {
      return fail("target.recording", quoted(recording), kRecordingFile);
    }
    require_file("target.recording", recording, kRecordingFile);
    if (!reading_.has("target.seed")) return;
    fail("target.seed", std::to_string(study_.target.seed),
         "left out with a recording: it picks the behavior of a truth");
  }

  // Those of a recording are known when it has been read.
  void check_truths_rollouts() {
    if (!study_.target.truth || !info_ || !reading_.good("target.num_rollouts")) return;
    // Features that are missing, or steps that only the inputs know.
    if (info_->state_channels.empty() || study_.target.inputs) return;
    check_rollouts(study_,
                   {study_.target.num_rollouts + study_.target.held_out, info_->num_steps,
                    info_->state_channels},
                   reading_);
  }

  void check_values(const std::string& path, const Numbers& values) {
    if (!info_) return;
    for (const auto& [name, value] : values) {
      const std::string member = fmt::format("{}.{}", path, name);
      const sim::Parameter* parameter = find_parameter(member, display(path), *info_, name);
      if (parameter != nullptr && reading_.good(member)) check_value(member, *parameter, value);
    }
  }

  void check_marginal(Marginal& marginal) {
    const std::string path = "prior." + marginal.name;
    if (study_.simulator.parameters.contains(marginal.name)) {
      reading_.fail(path, fmt::format("'{}' is in the prior and in simulator.parameters, must be "
                                      "in one of them",
                                      marginal.name));
    }
    if (!info_) return;
    const sim::Parameter* parameter = find_parameter(path, "prior", *info_, marginal.name);
    if (parameter == nullptr || !reading_.good(path)) return;
    marginal.unit = parameter->unit;
    check_bounds(marginal, *parameter, reading_);
  }

  // An observation is judged by the simulations of all rounds.
  void check_diagnose() {
    constexpr Index fewest = inference::kFewestSimulations;
    if (!reading_.has("diagnose")) return;
    bool means_something = study_.diagnose.checks.empty() || study_.methods.empty();
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      if (!reading_.good(fmt::format("method[{}].algorithm", i))) return;
      means_something |= !study_.diagnose_of(study_.methods[i]).checks.empty();
    }
    if (!means_something) {
      fail("diagnose.checks", fmt::format("[{}]", join(to_names(study_.diagnose.checks))),
           "such that one of them means something to a method: calibration needs a network, and "
           "more simulations than a dataset holds; 'held_out' needs target.held_out, 'dataset' a "
           "dataset");
    }
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      const inference::AlgorithmConfig& algorithm = study_.methods[i].algorithm;
      require(fmt::format("method[{}].num_simulations", i), algorithm.num_simulations,
              !study_.diagnose_of(study_.methods[i]).has(Check::ood) ||
                  algorithm.num_rounds * algorithm.num_simulations >= fewest,
              fmt::format("such that all rounds have {} or more with the check 'ood'", fewest));
    }
  }

  // They share the columns of tables with methods and baselines.
  void check_references() {
    std::set<std::string> names = {"prior", "nominal", "truth", "floor"};
    for (const MethodConfig& method : study_.methods) names.insert(folder_slug(method.name));
    for (std::size_t i = 0; i < study_.references.size(); ++i) {
      const std::string path = fmt::format("reference[{}]", i);
      const ReferenceConfig& reference = study_.references[i];
      check_values(path + ".parameters", reference.parameters);
      if (!reading_.good(path + ".name")) continue;
      require(path + ".name", reference.name, names.insert(folder_slug(reference.name)).second,
              "unlike other references, methods, 'prior', 'nominal', 'truth' and 'floor' in its "
              "letters a-z and digits");
    }
  }

  // By channels of the simulator, which a library knows and the study doesn't.
  void check_goal() {
    if (!info_) return;
    const std::string path = "simulator.goal.place";
    for (const auto& [label, value] : study_.external.goal.place) {
      require_known(path, path, "state channel", label, labels_of(info_->state_channels));
    }
    if (study_.external.goal.radius > 0.0 && study_.external.goal.place.empty()) {
      reading_.fail("simulator.goal.radius",
                    path + " is missing, must say where the goal is, by state channels");
    }
  }

  void check_metrics() {
    if (!info_ || !study_.source().gives_motion || !reading_.good("evaluate.metrics")) return;
    const auto differs = [&](const Channel& channel) {
      return channel.unit != info_->state_channels.front().unit;
    };
    const auto leave_out = [&](Metric metric, const std::string& why) {
      if (std::ranges::count(study_.evaluate.metrics, metric) == 0) return;
      fail("evaluate.metrics", quoted(name_of(metric)), "left out: " + why);
    };
    if (!info_->goal) {
      leave_out(Metric::goal, fmt::format("the simulator '{}' has no goal", info_->name));
    }
    if (std::ranges::any_of(info_->state_channels, differs)) {
      leave_out(Metric::final_error,
                fmt::format("the states of the simulator '{}' have several units", info_->name));
    }
  }

  // Which rollouts are held out is a count from the first that inference sees.
  void check_held_out() {
    const TargetConfig& target = study_.target;
    if (target.held_out == 0 || target.num_rollouts > 0 || !reading_.good("target.held_out"))
      return;
    fail("target.num_rollouts", "0", ">= 1 with held_out: the rollouts after those are held out");
  }

  void check_method_names() {
    std::map<std::string, std::string> names;  // by folder
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      const std::string path = fmt::format("method[{}].name", i);
      const std::string& name = study_.methods[i].name;
      if (!reading_.good(path)) continue;
      const auto [found, is_new] = names.emplace(folder_slug(name), name);
      const auto& [folder, other] = *found;
      require(path, name, is_new,
              name == other ? "unique"
                            : fmt::format("different from {} in its letters a-z and digits: both "
                                          "would have the folder '{}'",
                                          quoted(other), folder));
    }
  }

  void check_report() {
    std::vector<std::string> names;
    for (const Marginal& marginal : study_.prior) names.push_back(marginal.name);
    const auto require_parameter = [&](const std::string& path, const std::string& parameter) {
      require_known(path, path, "parameter of the prior", parameter, names);
    };
    const std::vector<std::string>& shown = study_.report.parameters;
    for (const std::string& parameter : shown) require_parameter("report.parameters", parameter);
    for (const auto& [parameter, symbol] : study_.report.symbols) {
      require_parameter("report.symbols", parameter);
      if (analysis::is_latex_symbol(symbol)) continue;
      fail("report.symbols." + parameter, shortened(symbol),
           "a formula of letters, digits, _ ^ { } and commands such as \\theta or \\dot, without "
           "$");
    }
    if (shown.empty() || !reading_.good("report.parameters")) return;
    const bool are_distinct = std::set(shown.begin(), shown.end()).size() == shown.size();
    const Range counts{analysis::kMinPairParameters, analysis::kMaxPairParameters};
    if (are_distinct && counts.contains(static_cast<double>(shown.size()))) return;
    fail("report.parameters", fmt::format("[{}]", shortened(join(shown))),
         fmt::format("{} to {} different parameters of the prior, or none",
                     analysis::kMinPairParameters, analysis::kMaxPairParameters));
  }

  Study& study_;
  std::optional<sim::SimulatorInfo> info_;
};

}  // namespace

void check_study(Study& study, Reading& reading) { StudyChecker(study, reading).check(); }

}  // namespace npdr::pipeline
