/// A study: target domain, simulator, prior and the methods to compare. Plain data; every default
/// is here, and pipeline/config/study_fields.h says what each field means and may hold.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"
#include "inference/abc/abc_config.h"
#include "inference/algorithms/algorithm_config.h"
#include "inference/embeddings/embedding_config.h"
#include "inference/estimators/estimator_config.h"
#include "inference/linear_regression/linear_regression_config.h"
#include "inference/prior.h"
#include "inference/samplers/importance_config.h"
#include "inference/training_config.h"
#include "pipeline/config/cluster_config.h"
#include "pipeline/config/external_config.h"
#include "pipeline/config/metric.h"
#include "pipeline/config/policy_config.h"
#include "pipeline/config/reading.h"
#include "pipeline/config/source_traits.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Source of the target domain's rollouts: exactly one of `recording`, `truth` and, where the
/// simulator gives no rollouts, `observation`.
struct TargetConfig {
  std::optional<std::string> recording;                ///< path, as seen from the current folder
  std::optional<std::string> observation;              ///< the same, of a file that holds x_o
  std::optional<std::map<std::string, double>> truth;  ///< parameters that aren't nominal
  std::optional<std::string> inputs;    ///< path of a recording that a truth's rollouts begin like
  std::vector<std::uint64_t> rollouts;  ///< of the recording, counted from 1; empty: all
  Index num_rollouts = 0;               ///< that inference sees, of those; 0: all
  Index held_out = 0;                   ///< after those, for evaluation alone
  std::uint64_t seed = 0;               ///< picks a truth's random behavior
};

/// Noise on the simulated states that the inference sees (sim/noise_model.h). Priors are pairs of a
/// median and a deviation.
struct ObservationNoise {
  double scale = 0.0;  ///< standard deviation / largest recorded magnitude of the channel
  std::optional<std::vector<double>> scale_prior;
  std::optional<std::map<std::string, double>> std;  ///< by channel, in its unit, in place of scale
  std::optional<double> correlation;
  std::optional<std::vector<double>> correlation_prior;
  std::optional<double> degrees_of_freedom;
  std::optional<std::vector<double>> degrees_of_freedom_prior;
  bool redraw = true;  ///< fresh noise in each training epoch, not once per simulation

  bool is_silent() const { return scale == 0.0 && !scale_prior && !std; }
  bool is_correlated() const { return correlation || correlation_prior; }
  bool is_heavy_tailed() const { return degrees_of_freedom || degrees_of_freedom_prior; }
};

/// The model in words: "white, scale 0.3"; "correlated and heavy-tailed, scale inferred, ...".
std::string to_text(const ObservationNoise& noise);

struct SimulateConfig {
  Index shard_size = 1000;  ///< [rows]
};

/// Which rounds' posteriors are evaluated.
enum class EvaluatedRounds { last, all };
constexpr auto enum_table(EvaluatedRounds) {
  return std::to_array<EnumRow<EvaluatedRounds>>(
      {{EvaluatedRounds::last, "last"}, {EvaluatedRounds::all, "all"}});
}

struct EvaluateConfig {
  Index num_samples = 1000;
  std::vector<Metric> metrics = {Metric::dtw, Metric::rmse};
  EvaluatedRounds rounds = EvaluatedRounds::last;
  bool floor = true;    ///< search for the smallest RMSE in the prior, too; only with a recording
  Index leave_out = 0;  ///< parts of the rollouts that methods predict from the others; 0: none
};

enum class Check;  // check.h

/// How posteriors are checked.
struct DiagnoseConfig {
  std::vector<Check> checks;  ///< all where the study has a [diagnose], else those that cost little
  Index num_simulations = 300;  ///< fresh draws of the prior, to calibrate with
  Index num_samples = 1000;     ///< drawn from each posterior
  double alpha = 0.01;          ///< probability that a method without fault fails any of its checks

  bool has(Check check) const;
  /// Whether any of the checks needs fresh simulations.
  bool calibrates() const;
  /// The same without the checks of evaluated samples: what a diagnosis is made of.
  DiagnoseConfig of_diagnosis() const;
};

/// A named parameter vector to compare posteriors with.
struct ReferenceConfig {
  std::string name;
  std::map<std::string, double> parameters;  ///< that aren't the study's nominal ones
};

struct LimitsConfig {
  double max_failed_fraction = 0.05;  ///< share of the rows of a simulation
};

struct ReportConfig {
  std::string title;                           ///< "": the study's name
  std::string caption;                         ///< below the main tables
  std::vector<std::string> parameters;         ///< those that pair plots show; empty: the first 15
  std::map<std::string, std::string> symbols;  ///< LaTeX of parameters
};

/// Somebody's figure to print beside ours.
struct PublishedFigure {
  double mean = 0.0;
  double std = 0.0;
};

/// Draws that predict left-out rollouts, for each power of the likelihood that is tried.
inline constexpr Index kLeftOutDraws = 1000;

/// Settings of the algorithm "refine".
struct RefineConfig {
  std::string start;                ///< the method whose posterior is refined; "": the prior alone
  bool infer_first_states = false;  ///< they are as noisy as the others
  inference::ImportanceConfig sampling;
};

/// One column of the study's tables.
struct MethodConfig {
  std::string name;
  inference::AlgorithmConfig algorithm = {.kind = inference::Algorithm::npe_nle};
  Index num_rollouts = 0;    ///< the first h of the target's rollouts; 0: all
  Index num_iterations = 1;  ///< each collects target rollouts, infers and searches for a policy
  Index policy_iterations = 20;  ///< steps of a policy search
  inference::EmbeddingConfig embedding;
  inference::EstimatorConfig density_estimator = {.num_networks = 5};
  inference::TrainingConfig training;
  inference::SamplerConfig sampler;
  inference::AbcConfig abc;
  inference::LinearRegressionConfig linear_regression;
  RefineConfig refine;
  std::map<std::string, PublishedFigure> published;  ///< by metric
};

/// The table [simulator] as a whole.
struct SimulatorTable {
  sim::SimulatorConfig built_in;
  ExternalConfig external;
};

struct Study {
  std::string name;
  std::vector<std::uint64_t> seeds = {1};  ///< distinct experiments
  TargetConfig target;
  sim::SimulatorConfig simulator;
  ExternalConfig external;                 ///< in the table of the simulator, in its place
  std::vector<inference::Marginal> prior;  ///< in the file's order; units are the simulator's
  ObservationNoise observation_noise;
  SimulateConfig simulate;
  std::vector<MethodConfig> methods;
  EvaluateConfig evaluate;
  DiagnoseConfig diagnose;
  PolicyConfig policy;
  std::vector<ReferenceConfig> references;
  LimitsConfig limits;
  ReportConfig report;
  ClusterConfig cluster;
  Places places;  ///< where each key stands in what the study was read from

  /// Traits of the source that its rows come from.
  const SourceTraits& source() const { return traits_of(external.kind()); }
  /// Of features: states of a motion keep theirs, whose differences count.
  inference::Tails tails() const {
    return source().gives_motion ? inference::Tails::kept : inference::Tails::compressed;
  }

  /// Throws InputError with the nearest name when no method is called `method_name`.
  const MethodConfig& method(const std::string& method_name) const;

  /// Why a check means nothing to a method that infers, for people; "": it does mean something.
  std::string why_unchecked(Check check, const MethodConfig& method) const;
  /// The checks that mean something to a method.
  DiagnoseConfig diagnose_of(const MethodConfig& method) const;

  /// How often a method collects target rollouts, infers and searches: once without [policy].
  Index num_iterations_of(const MethodConfig& method) const;
};

inference::AlgorithmFamily family_of(const MethodConfig& method);
/// Whether a method infers anything: "prior" and "nominal" take what there is before.
bool infers(const MethodConfig& method);
/// Whether it does from simulations that it is given, by a network or those near the observation.
bool learns(const MethodConfig& method);
/// Simulations of a round that a method's networks learn from: others choose the powers of a pool.
Index num_learned_from(const MethodConfig& method);
/// Whether an algorithm learns from rounds of simulations.
bool learns_from_rounds(inference::Algorithm algorithm);

/// The names of what a study measures: its metrics, and again with the prefix "held_out_" when
/// there are held-out rollouts.
std::vector<std::string> measured_names(const Study& study);
/// All that measured_names() can have.
std::vector<std::string> all_measured_names();
inline constexpr std::string_view kHeldOutPrefix = "held_out_";

/// A name as a folder: lower case letters, digits and '-': "NPDR (MAF)" is "npdr-maf".
std::string folder_slug(const std::string& name);

}  // namespace npdr::pipeline
