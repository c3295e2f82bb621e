/// A study: target domain, simulator, prior and the methods to compare. Plain data: every default
/// is here or in external_config.h; study_fields.h says what each field means and may hold.
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
#include "inference/least_squares/least_squares.h"
#include "inference/linear_regression/linear_regression_config.h"
#include "inference/policy_search/policy_search_config.h"
#include "inference/prior.h"
#include "inference/samplers/importance_config.h"
#include "inference/training_config.h"
#include "pipeline/config/external_config.h"
#include "pipeline/config/metric.h"
#include "pipeline/config/reading.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Source of the target domain's rollouts: exactly one of `recording`, `truth` and, where the
/// simulator gives no rollouts, `observation`. Paths are those seen from the current folder.
struct TargetConfig {
  std::optional<std::string> recording, observation;
  std::optional<std::map<std::string, double>> truth;
  std::optional<std::string> inputs;
  std::vector<std::uint64_t> rollouts;
  Index num_rollouts = 0, held_out = 0;
  std::uint64_t seed = 0;
};

/// Noise on the simulated states that the inference sees (sim/noise_model.h). Priors are pairs of a
/// median and a deviation.
struct ObservationNoise {
  double scale = 0.0;
  std::optional<std::vector<double>> scale_prior;
  std::optional<std::map<std::string, double>> std;  ///< by channel, in its unit
  std::optional<double> correlation;
  std::optional<std::vector<double>> correlation_prior;
  std::optional<double> degrees_of_freedom;
  std::optional<std::vector<double>> degrees_of_freedom_prior;
  bool redraw = true;

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
  bool floor = true;
  Index leave_out = 0;
};

enum class Check;  // check.h

/// How posteriors are checked.
struct DiagnoseConfig {
  std::vector<Check> checks;
  Index num_simulations = 300, num_samples = 1000;
  double alpha = 0.01;

  bool has(Check check) const;
  /// Whether any of the checks needs fresh simulations.
  bool calibrates() const;
  /// The same without the checks of evaluated samples: what a diagnosis is made of.
  DiagnoseConfig of_diagnosis() const;
};

/// A named parameter vector to compare posteriors with.
struct ReferenceConfig {
  std::string name;
  std::map<std::string, double> parameters;
};

struct LimitsConfig {
  double max_failed_fraction = 0.05;
};

struct ReportConfig {
  std::string title, caption;
  std::vector<std::string> parameters;  ///< those that pair plots show
  std::map<std::string, std::string> symbols;
};

/// Somebody's figure to print beside ours.
struct PublishedFigure {
  double mean = 0.0, std = 0.0;
};

/// Draws that predict left-out rollouts, for each power of the likelihood that is tried.
inline constexpr Index kLeftOutDraws = 1000;

/// Settings of the algorithm "refine".
struct RefineConfig {
  std::string start;
  bool infer_first_states = false;
  inference::ImportanceConfig sampling;
};

/// One column of the study's tables.
struct MethodConfig {
  std::string name;
  inference::AlgorithmConfig algorithm = {.kind = inference::Algorithm::npe_nle};
  Index num_rollouts = 0, num_iterations = 1, policy_iterations = 20;
  inference::EmbeddingConfig embedding;
  inference::EstimatorConfig density_estimator = {.num_networks = 5};
  inference::TrainingConfig training;
  inference::SamplerConfig sampler;
  inference::AbcConfig abc;
  inference::LinearRegressionConfig linear_regression;
  inference::LeastSquaresConfig least_squares;
  RefineConfig refine;
  std::map<std::string, PublishedFigure> published;  ///< by metric
};

/// One axis of the grid that policies are tested on: a domain parameter, and its values.
struct PolicyGridAxis {
  std::string parameter;
  std::vector<double> range;
  Index steps = 7;
  std::vector<double> values;

  bool is_used() const { return !parameter.empty(); }
  /// The values, ascending.
  std::vector<double> points() const;
};

struct PolicyGrid {
  PolicyGridAxis x, y;

  bool is_used() const { return x.is_used() && y.is_used(); }
};

/// Policy search.
struct PolicyConfig {
  Index num_domain_parameters = 50, num_initial_states = 4, num_test_states = 100, num_steps = 0;
  std::map<std::string, double> initial, model;
  /// The search; its num_iterations stand elsewhere.
  inference::PolicySearchConfig search = {.kind = inference::PolicyOptimizerKind::none};
  PolicyGrid grid;

  bool is_used() const { return search.kind != inference::PolicyOptimizerKind::none; }
};

/// Tasks that may help one refinement: an array of a cluster with usual settings.
inline constexpr Index kMostHelpers = 1000;

/// Resources that a job of one stage asks for. Empty, or 0: as the whole [cluster] says.
struct StageResources {
  Index cpus = 0;
  std::string memory, time;
  std::vector<std::string> sbatch;
};

/// How a batch system is asked to run a study: the table [cluster] of a study or of a site's file.
/// No artefact depends on it. `prepare` is of targets and proposals, `policy` of searches and
/// tests.
struct ClusterConfig {
  std::string partition, account;
  Index cpus = 1;
  std::string memory, time;
  Index array_limit = 0, max_array_size = 0;
  double task_minutes = 5.0;
  Index refine_tasks = 0;
  Index signal_seconds = 120;
  std::string scratch, mail;
  std::vector<std::string> setup, sbatch;
  StageResources prepare, simulate, infer, baseline, evaluate, diagnose, policy, report;
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

  /// The least-squares fit that errors of a recording's posteriors are compared with; nullptr:
  /// none.
  const MethodConfig* floor_method() const;

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
