#include "pipeline/config/study_check.h"

#include <optional>
#include <set>

#include "analysis/latex_symbols.h"
#include "analysis/pair_plot.h"
#include "core/error.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "pipeline/config/check.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

class StudyChecker : Checker {
 public:
  StudyChecker(Study& study, const sim::SimulatorInfo* info, Reading& reading)
      : Checker(study, info, reading), prior_(study.prior) {}

  void check() {
    check_source(study_, info_, reading_);
    check_noise();
    check_target();
    check_values("simulator.parameters", study_.simulator.parameters);
    for (Marginal& marginal : prior_) check_marginal(marginal);
    check_method_names();
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      check_method(study_, i, info_, reading_);
    }
    check_diagnose();
    check_references();
    check_goal();
    check_metrics();
    // Which rollouts are held out is a count from the first that inference sees.
    require("target.num_rollouts", study_.target.num_rollouts,
            study_.target.held_out == 0 || study_.target.num_rollouts > 0,
            ">= 1 with held_out: the rollouts after those are held out", {"target.held_out"});
    check_report();
    check_policy(study_, info_, reading_);
    check_cluster();
    check_truths_rollouts();
    check_simulator();
  }

 private:
  // The simulator has the last word on its settings; its message has no position.
  void check_simulator() {
    if (!reading_.is_fine() || !study_.source().is_built_in) return;
    try {
      sim::make_simulator(study_.simulator);
    } catch (const InputError& error) {
      fail("simulator", error.what());
    }
  }

  void check_noise() {
    const ObservationNoise& noise = study_.observation_noise;
    const std::string path = "observation_noise.std", member = path + ".";
    must_be_left_out(unused_fields(fields_of(noise), "observation_noise"));
    if (!noise.is_silent() && !study_.source().gives_motion) {
      must_be_left_out({"observation_noise.correlation", "observation_noise.correlation_prior"},
                       "the simulator gives features, which have no neighbors in time");
    }
    if (!noise.std) return;
    auto labels = info_ ? labels_of(info_->state_channels) : std::vector<std::string>();
    for (const auto& [label, deviation] : *noise.std) {
      require(member + label, deviation, deviation >= 0.0, ">= 0");
      if (labels.empty()) continue;  // features may not be known yet
      require_known(member + label, path, "channel", label, labels);
    }
    // The likelihood of a refinement is that of every channel's noise.
    const auto refines = [](const MethodConfig& method) {
      return method.algorithm.kind == inference::Algorithm::refine;
    };
    if (std::ranges::none_of(study_.methods, refines)) return;
    const std::string needed = "algorithm 'refine' needs noise in each channel";
    for (const auto& [label, deviation] : *noise.std) {
      require(member + label, deviation, deviation != 0.0, "> 0: " + needed);
      std::erase(labels, label);
    }
    if (labels.empty() || noise.scale > 0.0 || noise.scale_prior) return;
    reading_.reject(path, "without " + join(labels),
                    "of all channels, or beside a scale or scale_prior of the others: " + needed);
  }

  void check_target() {
    const TargetConfig& target = study_.target;
    if (target.truth) check_values("target.truth", *target.truth);
    if (!study_.source().gives_motion) return;
    if (reading_.good("target.recording") && reading_.good("target.truth") &&
        !require_one_of("target", target.recording.has_value(), "recording = \"file.h5\"",
                        target.truth.has_value(), "truth = { parameter = value }")) {
      return;
    }
    if (target.recording) {
      require_recording("target.recording", *target.recording);
      must_be_left_out({"target.seed"}, "it picks the behavior of a truth");
    }
    if (!target.truth) return must_be_left_out({"target.inputs"}, "it is for a truth");
    if (target.inputs) require_recording("target.inputs", *target.inputs);
    must_be_left_out({"target.rollouts"}, "it picks those of a recording");
    require("target.num_rollouts", target.num_rollouts, target.num_rollouts >= 1 || target.inputs,
            ">= 1 with a truth: there is no recording to take all of");
  }

  void require_recording(const std::string& path, const std::string& file) {
    const std::string words = "an existing HDF5 file; 'npdr import' makes one of CSV files";
    if (require(path, file, !file.ends_with(".csv"), words)) require_file(path, file, words);
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

  void check_marginal(Marginal& marginal) {
    const std::string path = "prior." + marginal.name;
    if (study_.simulator.parameters.contains(marginal.name)) {
      fail(path, "'" + marginal.name +
                     "' is in the prior and in simulator.parameters, must be in one of them");
    }
    if (!info_) return;
    const sim::Parameter* parameter = find_parameter(path, "prior", marginal.name);
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
      if (!reading_.good(method_path(i) + ".algorithm")) return;
      means_something |= !study_.diagnose_of(study_.methods[i]).checks.empty();
    }
    if (!means_something) {
      reading_.reject(
          "diagnose.checks", fmt::format("[{}]", join(to_names(study_.diagnose.checks))),
          "such that one of them means something to a method: calibration needs a network, and "
          "more simulations than a dataset holds; 'held_out' needs target.held_out, 'dataset' a "
          "dataset");
    }
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      const inference::AlgorithmConfig& algorithm = study_.methods[i].algorithm;
      require(method_path(i) + ".num_simulations", algorithm.num_simulations,
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
      fail("simulator.goal.radius",
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
      reading_.reject("evaluate.metrics", quoted(name_of(metric)), "left out: " + why);
    };
    if (!info_->goal) {
      leave_out(Metric::goal, fmt::format("the simulator '{}' has no goal", info_->name));
    }
    if (std::ranges::any_of(info_->state_channels, differs)) {
      leave_out(Metric::final_error,
                fmt::format("the states of the simulator '{}' have several units", info_->name));
    }
  }

  // A job would be asked to stop before it has begun.
  void check_cluster() {
    const ClusterConfig& cluster = study_.cluster;
    const auto check_time = [&](const std::string& path, const Field& field) {
      if (field.key != "time" || field.value == "" || !reading_.good(path)) return;
      const std::string time = field.value;
      require(path, time, seconds_of(time) > static_cast<double>(cluster.signal_seconds),
              fmt::format("longer than cluster.signal_seconds = {}", cluster.signal_seconds),
              {"cluster.signal_seconds"});
    };
    for (const Field& field : fields_of(cluster)) {
      const std::string path = "cluster." + field.key;
      check_time(path, field);
      if (field.kind != Field::Kind::table) continue;
      for (const Field& member : field.members.front()) check_time(path + ".time", member);
    }
  }

  void check_method_names() {
    std::map<std::string, std::string> names;  // by folder
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      const std::string path = method_path(i) + ".name";
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
      reading_.reject(
          "report.symbols." + parameter, shortened(symbol),
          "a formula of letters, digits, _ ^ { } and commands such as \\theta or \\dot, without "
          "$");
    }
    if (shown.empty() || !reading_.good("report.parameters")) return;
    const bool are_distinct = std::set(shown.begin(), shown.end()).size() == shown.size();
    const Range counts{analysis::kMinPairParameters, analysis::kMaxPairParameters};
    if (are_distinct && counts.contains(static_cast<double>(shown.size()))) return;
    reading_.reject("report.parameters", fmt::format("[{}]", shortened(join(shown))),
                    fmt::format("{} to {} different parameters of the prior, or none",
                                analysis::kMinPairParameters, analysis::kMaxPairParameters));
  }

  std::vector<Marginal>& prior_;
};

}  // namespace

void check_study(Study& study, Reading& reading) {
  std::optional<sim::SimulatorInfo> info;
  try {
    if (has_source(study, reading)) info = simulator_info(study);
  } catch (const InputError& error) {  // of a library, or a model of MuJoCo
    reading.fail(study.external.mjcf ? "simulator.mjcf" : "simulator.library", error.what());
  }
  StudyChecker(study, info ? &*info : nullptr, reading).check();
}

}  // namespace npdr::pipeline
