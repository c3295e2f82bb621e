/// One description of every field of a study: key, place in memory, what it may hold, one line of
/// documentation. The visitors that walk it read TOML (field_reader.h), write JSON
/// (json_fields.h) and list the keys (study_keys.h), so that none of them can forget a field.
///
/// A visitor has three members, whose last argument may be left out (field_use.h):
///   f(key, value, constraint, doc, use)  a field; a default that isn't allowed makes it required
///   f.table(key, doc, body, use)         a table: body(visitor of its members)
///   f.list(key, values, minimum, doc, body, use)
///                                        a list of tables: body(visitor of its members, element)
#pragma once

#include <fmt/format.h>

#include "analysis/pair_plot.h"
#include "core/constants.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "pipeline/config/check.h"
#include "pipeline/config/choice_field.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/field_types.h"
#include "pipeline/config/field_use.h"
#include "pipeline/config/simulator_fields.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// The widest layer of a network, and the most layers, transforms or components: far beyond what
/// trains, and a network of a hostile file still fits in memory.
inline constexpr double kMaxWidth = 4096;
inline constexpr double kMaxLayers = 128;
/// The most rollouts, steps or channels of a posterior file: their product fits into an integer.
inline constexpr double kMaxSeries = 1e6;

/// > 0 and <= 1.
/// [median, deviation] of noise, the median above `low` and below `high`, the deviation > 0.
Constraint<std::vector<double>> noise_prior(double low, const std::string& name,
                                            double high = kInfinity);
Constraint<double> correlation_constraint();
Constraint<double> degrees_constraint();
Constraint<double> quantile_constraint();
/// States of a smoother's window: odd, 5 to 1001.
Constraint<double> window_constraint();
Constraint<std::vector<std::uint64_t>> seeds_constraint();
Constraint<double> rounds_constraint();
Constraint<std::vector<std::uint64_t>> rollouts_constraint();
/// A number of folds, or none.
Constraint<double> folds_constraint();
Constraint<std::vector<std::string>> metrics_constraint();
Constraint<std::vector<std::string>> checks_constraint();
/// [low, high].
Constraint<std::vector<double>> range_constraint();
/// Ascending.
Constraint<std::vector<double>> ascending();
Constraint<std::vector<inference::Marginal>> prior_constraint();
/// Memory as Slurm takes it: "2G"; "" for none.
Constraint<std::string> memory_constraint();
/// Time as Slurm takes it: "90", "01:30:00", "1-12"; "" for none.
Constraint<std::string> time_constraint();
/// Value behind the = of a batch system's option: one word, or nothing.
Constraint<std::string> option_value();
/// Lines such as "--qos=long".
Constraint<std::vector<std::string>> options_constraint();
Constraint<std::vector<std::string>> shell_lines();

template <class Fields>
void describe(Fields& f, inference::EmbeddingConfig& c) {
  choice(f, "kind", c.kind,
         "how rollouts become features; where it is left out and features or average_rollouts are "
         "given, `convolution` for networks of a posterior");
  f("features", c.features, between(1, kMaxWidth),
    "width of the trained layer (\"convolution\": of the last, and \"linear\"); twice the "
    "parameters when left out, if that is more");
  f("average_rollouts", c.average_rollouts, anything<bool>(),
    "\"convolution\" only: the last layer sees the mean over rollouts, not each by itself");
  f("principal_components", c.principal_components, count_from(0),
    "of the features, at most as many as there are, for the network to see; 0: the features "
    "themselves; where none of kind, features, average_rollouts and this is given, networks have "
    "four times the parameters, 20 to 50");
  f("downsample", c.downsample, count_from(1),
    "keep every k-th state; a multiple of simulator.store_every, which it is when left out");
  f("channels", c.channels, anything<std::vector<std::string>>(),
    "state channels to keep; empty: all");
}

template <class Fields>
void describe(Fields& f, inference::TrainedEmbeddingConfig& c) {
  f("features", c.features, between(0, kMaxWidth), "width of the last layer; 0: none is trained");
  f("num_rollouts", c.series.num_rollouts, between(0, kMaxSeries), "of the convolved series");
  f("num_steps", c.series.num_steps, between(0, kMaxSeries), "of each of them");
  f("num_channels", c.series.num_channels, between(0, kMaxSeries), "of each step");
  f("average_rollouts", c.average_rollouts, anything<bool>(), "before the last layer");
}

template <class Fields>
void describe(Fields& f, inference::EstimatorConfig& c) {
  choice(f, "kind", c.kind,
         "masked autoregressive flow, mixture of Gaussians, neural spline flow, residual network");
  f("num_networks", c.num_networks, between(c.kNumNetworks),
    "trained side by side, each from other weights and on another part of the simulations; the "
    "posterior is the mean of theirs");
  f("num_transforms", c.num_transforms, between(1, kMaxLayers),
    "autoregressive transforms (\"maf\" and \"nsf\" only)");
  f("num_bins", c.num_bins, between(c.kNumBins), "bins of each spline (\"nsf\" only)");
  f("num_components", c.num_components, between(1, kMaxLayers),
    "Gaussians in the mixture (\"mdn\" only)");
  f("hidden_features", c.hidden_features, between(1, kMaxWidth), "width of each hidden layer");
  f("num_hidden_layers", c.num_hidden_layers, between(1, kMaxLayers),
    "hidden layers (per transform), or residual blocks");
}

template <class Fields>
void describe(Fields& f, inference::TrainingConfig& c) {
  f("learning_rate", c.learning_rate, quantile_constraint(), "step size of Adam");
  f("batch_size", c.batch_size, count_from(1),
    "simulations per step of the optimizer; all that train when left out and they are fewer");
  f("validation_fraction", c.validation_fraction, strictly_between(0, 1),
    "share of the simulations that early stopping is judged on");
  f("stop_after_epochs", c.stop_after_epochs, count_from(1),
    "epochs without a better validation loss before training stops");
  f("max_epochs", c.max_epochs, count_from(1), "epochs at most, in each round");
  f("clip_norm", c.clip_norm, positive(),
    "largest Euclidean norm of a gradient; longer ones are scaled");
  f("average_epochs", c.average_epochs, not_negative(),
    "memory of the weights' moving average, which is validated and kept; 0: none");
}

template <class Fields>
void describe(Fields& f, inference::SamplerConfig& c) {
  choice(f, "kind", c.kind, "Markov chains, or resampled draws of the prior");
  f("num_chains", c.num_chains, between(1, 100'000), "chains side by side (\"slice\" only)");
  f("num_warmup", c.num_warmup, between(0, 1'000'000),
    "sweeps that each chain makes first (\"slice\" only)");
  f("thin", c.thin, between(1, 100'000), "sweeps between two samples of a chain (\"slice\" only)");
  f("num_candidates", c.num_candidates, between(1, 10'000'000),
    "draws of the prior that chains climb from, or that are resampled");
}

template <class Fields>
void describe(Fields& f, inference::AbcConfig& c) {
  choice(f, "distance", c.distance, "of features, or a metric of trajectories");
  f("quantile", c.quantile, quantile_constraint(),
    "the nearest simulations that are accepted, as a share of round 1, or for \"abc_smc\" (0.5 "
    "when "
    "left out) of the last population");
  f("epsilon", c.epsilon, not_negative(),
    "largest distance that is accepted; 0: by quantile; \"abc_smc\" ends there");
  f("smooth", c.smooth, anything<bool>(),
    "move posterior samples by a draw of the density's kernel");
}

template <class Fields>
void describe(Fields& f, inference::LinearRegressionConfig& c) {
  f("window", c.window, window_constraint(),
    "states that are smoothed over to differentiate a recording");
  f("num_samples", c.num_samples, between(2, 10'000'000),
    "of the regression's weights, mapped to parameters");
}

template <class Fields>
void describe(Fields& f, RefineConfig& c) {
  f("start", c.start, anything<std::string>(),
    "the method whose posterior is refined; empty: begin with the prior",
    {.affects = Affects::elsewhere});
  f("likelihood_power", c.sampling.likelihood_power, quantile_constraint(),
    "of the likelihood; below 1 for simulators that can't reproduce the recording");
  f("cross_validate", c.sampling.cross_validate, anything<bool>(),
    "choose the power, at most likelihood_power, that predicts left-out rollouts best");
  f("infer_first_states", c.infer_first_states, anything<bool>(),
    "integrate the noise of recorded first states out, by a rollout more for each state channel");
  f("level_size", c.sampling.level_size, between(1000, 10'000'000),
    "simulations from one proposal");
  f("min_ess", c.sampling.min_ess, between(100, 1'000'000),
    "effective sample size of the weighted draws");
  f("max_simulations", c.sampling.max_simulations, count_from(3000),
    "in all, at most; at least three levels");
}

/// Use of a setting that not all algorithms read: `reads` says whether this one does.
FieldUse use_of_algorithm(inference::Algorithm algorithm, bool reads,
                          Affects affects = Affects::results);

template <class Fields>
void describe(Fields& f, inference::AlgorithmConfig& c) {
  using enum inference::Algorithm;
  const FieldUse of_rounds =
      use_of_algorithm(c.kind, learns_from_rounds(c.kind), Affects::elsewhere);
  choice(f, "algorithm", c.kind, "inference algorithm");
  f("num_rounds", c.num_rounds, rounds_constraint(), "rounds of proposing, simulating and training",
    of_rounds);
  f("num_simulations", c.num_simulations, count_from(1), "simulations per round", of_rounds);
  f("num_atoms", c.num_atoms, count_from(2),
    "parameter sets that the atomic loss and \"nre_b\" compare per simulation",
    use_of_algorithm(c.kind, c.kind == npe_c || c.kind == nre_b));
  f("component_perturbation", c.component_perturbation, not_negative(),
    "\"npe_a\": noise on the Gaussians that its last round makes of one",
    use_of_algorithm(c.kind, c.kind == npe_a));
  choice(f, "loss", c.loss,
         "loss of later rounds; \"analytic\" needs \"mdn\"; \"auto\": that there, else \"atomic\"",
         use_of_algorithm(c.kind, c.kind == npe_c));
  f("combined_loss", c.combined_loss, anything<bool>(),
    "atomic loss: also fit the simulations of the prior by maximum likelihood",
    use_of_algorithm(c.kind, c.kind == npe_c));
}

template <class Fields>
void describe(Fields& f, PublishedFigure& c) {
  f("mean", c.mean, anything<double>(), "published mean");
  f("std", c.std, not_negative(), "published standard deviation");
}

/// Use of a method's setting that means something with [policy] alone.
FieldUse use_of_iterations(const MethodConfig& method, const PolicyConfig& policy, bool reads);

/// `policy`: of its study.
template <class Fields>
void describe(Fields& f, MethodConfig& c, const PolicyConfig& policy = {}) {
  using enum inference::AlgorithmFamily;
  const inference::Algorithm algorithm = c.algorithm.kind;
  const inference::AlgorithmFamily family = inference::traits_of(algorithm).family;
  const auto use_of = [&](bool reads, Affects affects = Affects::results) {
    return use_of_algorithm(algorithm, reads, affects);
  };
  f("name", c.name, label(), "column title in the tables; unique", {.affects = Affects::report});
  describe(f, c.algorithm);
  f("num_rollouts", c.num_rollouts, count_from(0),
    "use the first k rollouts of the target only; 0: all", use_of(infers(c)));
  f("num_iterations", c.num_iterations, between(1, 1000),
    "with [policy]: how often rollouts are collected and a policy is searched",
    use_of_iterations(c, policy, infers(c)));
  f("policy_iterations", c.policy_iterations, between(1, 100'000),
    "with [policy]: steps of each policy search", use_of_iterations(c, policy, true));
  // Distances of trajectories look at no embedding.
  const bool is_embedded = family != abc || c.abc.distance == inference::AbcDistance::euclidean;
  f.table(
      "embedding", "the features that inference sees", [&](auto& t) { describe(t, c.embedding); },
      use_of(learns_from_rounds(algorithm), is_embedded ? Affects::results : Affects::elsewhere));
  f.table(
      "density_estimator", "the network that learns the posterior",
      [&](auto& t) { describe(t, c.density_estimator); }, use_of(family == network));
  f.table(
      "training", "how the network is trained", [&](auto& t) { describe(t, c.training); },
      use_of(family == network));
  f.table(
      "sampler", "how posteriors of a learned likelihood or ratio are sampled",
      [&](auto& t) { describe(t, c.sampler); },
      use_of(inference::traits_of(algorithm).role != inference::NetworkRole::posterior));
  f.table(
      "abc", "approximate Bayesian computation: \"abc_rejection\", \"abc_mcmc\", \"abc_smc\"",
      [&](auto& t) { describe(t, c.abc); }, use_of(family == abc));
  f.table(
      "linear_regression", "the algorithm \"linear_regression\"",
      [&](auto& t) { describe(t, c.linear_regression); }, use_of(family == regression));
  FieldUse of_refinements = use_of(family == likelihood);
  of_refinements.omitted = family != likelihood;
  f.table(
      "refine", "the algorithm \"refine\"", [&](auto& t) { describe(t, c.refine); },
      of_refinements);
  f("published", c.published, anything<std::map<std::string, PublishedFigure>>(),
    "somebody's figures to print beside ours, by metric: mean and std",
    use_of(infers(c), Affects::report));
}

template <class Fields>
void describe(Fields& f, ReferenceConfig& c) {
  f("name", c.name, label(), "column title in the tables; unique");
  f("parameters", c.parameters, few_numbers(), "values that differ from the study's nominal ones");
}

template <class Fields>
void describe(Fields& f, TargetConfig& c) {
  f("recording", c.recording, file_path(),
    "HDF5 file of recorded rollouts, relative to the study file's folder");
  f("observation", c.observation, file_path(),
    "CSV or HDF5 file of x_o, where the simulator gives features, not rollouts");
  f("truth", c.truth, few_numbers(),
    "parameters of a simulated target that aren't nominal; {}: none");
  f("inputs", c.inputs, file_path(),
    "recording whose initial states and actions a truth's rollouts have; without it those of the "
    "simulator");
  f("rollouts", c.rollouts, rollouts_constraint(),
    "those of the recording that are used, counted from 1: [3, 4, 5, 1]; all when left out");
  f("num_rollouts", c.num_rollouts, count_from(0),
    "use the first k rollouts; 0: all of a recording; 5 for a truth without inputs when left out");
  f("held_out", c.held_out, count_from(0),
    "rollouts after those, which only the evaluation sees; needs num_rollouts");
  f("seed", c.seed, not_negative(), "picks a truth's random behavior, and its observation noise");
}

template <class Fields>
void describe(Fields& f, ObservationNoise& c) {
  f("scale", c.scale, not_negative(),
    "standard deviation / largest recorded magnitude of the channel in a rollout");
  const auto without = [&](const char* number, bool is_given) {
    const std::string key = std::string("observation_noise.") + number;
    return FieldUse{.unused = unless(!is_given, key + " is given")};
  };
  const FieldUse of_noise = {.unused = unless(!c.is_silent(),
                                              "there is no noise without observation_noise.scale, "
                                              "scale_prior or std")};
  f("scale_prior", c.scale_prior, noise_prior(0.0, "scale"),
    "[median, deviation of the logarithm], in place of scale: it isn't known",
    without("scale", c.scale > 0.0));
  f("std", c.std, few_numbers(),
    "standard deviation of some channels in their units, in place of scale: { theta = 0.01 }");
  f("correlation", c.correlation, correlation_constraint(),
    "of neighboring stored states' noise, which begins anew in each segment; none when left out",
    of_noise);
  f("correlation_prior", c.correlation_prior, noise_prior(0.0, "correlation", 1.0),
    "[median, deviation of log(c / (1 - c))], in place of correlation",
    c.is_silent() ? of_noise : without("correlation", c.correlation.has_value()));
  f("degrees_of_freedom", c.degrees_of_freedom, degrees_constraint(),
    "of Student's t, in place of Gaussian noise", of_noise);
  f("degrees_of_freedom_prior", c.degrees_of_freedom_prior, noise_prior(1.0, "degrees of freedom"),
    "[median, deviation of log(nu - 1)], in place of degrees_of_freedom",
    c.is_silent() ? of_noise : without("degrees_of_freedom", c.degrees_of_freedom.has_value()));
  f("redraw", c.redraw, anything<bool>(),
    "fresh noise in each training epoch, instead of once per simulation",
    {.affects = Affects::training});
}

template <class Fields>
void describe(Fields& f, EvaluateConfig& c) {
  f("num_samples", c.num_samples, count_from(1),
    "posterior samples that are simulated and measured");
  choices(f, "metrics", c.metrics, metrics_constraint(), "what simulated rollouts are measured by");
  choice(f, "rounds", c.rounds, "which rounds' posteriors are evaluated");
  f("floor", c.floor, anything<bool>(),
    "of a recording: also search for the smallest RMSE in the prior");
  f("leave_out", c.leave_out, folds_constraint(),
    "folds: every method is repeated without each k-th part of the rollouts, to predict it; 0: "
    "not");
}

template <class Fields>
void describe(Fields& f, DiagnoseConfig& c) {
  choices(f, "checks", c.checks, checks_constraint(),
          "what posteriors are checked by; all of them when left out, [] for none; without the "
          "table, those that cost little");
  f("num_simulations", c.num_simulations, between(inference::kFewestSimulations, 1'000'000),
    "fresh draws of the prior that are simulated, to calibrate with",
    {.affects = c.calibrates() ? Affects::results : Affects::report});
  f("num_samples", c.num_samples, between(inference::kFewestSimulations, 1'000'000),
    "posterior samples per observation");
  f("alpha", c.alpha, strictly_between(0, 1),
    "probability that a method without fault fails any of its checks",
    {.affects = Affects::report});
}

template <class Fields>
void describe(Fields& f, PolicyGridAxis& c) {
  f("parameter", c.parameter, anything<std::string>(),
    "a domain parameter of the simulator, another for each axis");
  f("range", c.range, range_constraint(), "its first and last value");
  f("steps", c.steps, between(2, 100), "values in that range, at equal distances");
  f("values", c.values, ascending(), "its values, in place of range and steps");
}

template <class Fields>
void describe(Fields& f, PolicyConfig& c) {
  using enum inference::PolicyOptimizerKind;
  const FieldUse of_task = {.affects = Affects::task}, of_tests = {.affects = Affects::elsewhere};
  const auto only_of = [&](inference::PolicyOptimizerKind optimizer) {
    return FieldUse{.unused = unless(c.search.kind == optimizer,
                                     fmt::format("it means nothing to the optimizer '{}'",
                                                 name_of(c.search.kind))),
                    .settable = true};
  };
  choice(f, "optimizer", c.search.kind, "how policies are searched for; \"power\" when left out");
  f("population", c.search.population, between(2, 100'000),
    "candidates per search iteration, beside the current policy");
  f("num_domain_parameters", c.num_domain_parameters, between(1, 1'000'000),
    "fresh posterior samples that each candidate of an iteration is tried on");
  f("num_initial_states", c.num_initial_states, between(1, 1'000'000),
    "initial states that each candidate is tried from, for each of them");
  f("num_test_states", c.num_test_states, between(20, 1'000'000),
    "initial states that a policy is tested from", of_tests);
  f("num_steps", c.num_steps, count_from(0), "of a rollout; 0: as many as the simulator has",
    of_task);
  f("initial", c.initial, few_numbers(),
    "parameters of the policy that begin elsewhere: { energy_gain = 30.0 }", of_task);
  f("model", c.model, few_numbers(),
    "domain parameters that the policy believes in, in place of the nominal ones", of_task);
  f("initial_std", c.search.initial_std, positive(),
    "deviation of the first candidates, in the coordinates of the search");
  f("min_std", c.search.min_std, positive(),
    "the deviation never falls below, in any direction; <= initial_std");
  f("num_importance_samples", c.search.num_importance_samples, between(1, 100'000),
    "\"power\": the best candidates so far, of which the next policy is made", only_of(power));
  f("elite_fraction", c.search.elite_fraction, quantile_constraint(),
    "\"cross_entropy\": share of the candidates of which the next policy is made",
    only_of(cross_entropy));
  f("smoothing", c.search.smoothing, quantile_constraint(),
    "\"cross_entropy\": weight of the new distribution against the old one",
    only_of(cross_entropy));
  const auto describe_grid = [&](auto& grid) {
    grid.table("x", "one axis of the grid", [&](auto& t) { describe(t, c.grid.x); });
    grid.table("y", "the other axis", [&](auto& t) { describe(t, c.grid.y); });
  };
  f.table("grid", "domain parameters that policies are tested on", describe_grid, of_tests);
}

template <class Fields>
void describe(Fields& f, ReportConfig& c) {
  f("title", c.title, anything<std::string>(), "title of the report; empty: the study's name");
  f("caption", c.caption, anything<std::string>(),
    "text below the main tables; blank lines separate paragraphs");
  f("parameters", c.parameters, anything<std::vector<std::string>>(),
    fmt::format("{} to {} parameters of the prior that pair plots show; empty: its first {}",
                analysis::kMinPairParameters, analysis::kMaxPairParameters,
                analysis::kMaxPairParameters));
  f("symbols", c.symbols, anything<std::map<std::string, std::string>>(),
    "LaTeX of parameters, for tables in papers, such as { pole_mass = 'm_p' }");
}

template <class Fields>
void describe(Fields& f, StageResources& c) {
  f("cpus", c.cpus, between(0, 4096), "cores of a task; 0: as [cluster] says");
  f("memory", c.memory, memory_constraint(), "of a task; empty: as [cluster] says");
  f("time", c.time, time_constraint(), "limit of a task; empty: as [cluster] says");
  f("sbatch", c.sbatch, options_constraint(), "further options, after those of [cluster]");
}

template <class Fields>
void describe(Fields& f, ClusterConfig& c) {
  f("partition", c.partition, option_value(), "of the cluster; empty: its default");
  f("account", c.account, option_value(), "that pays; empty: the user's default");
  f("cpus", c.cpus, between(1, 4096), "cores of a task");
  f("memory", c.memory, memory_constraint(),
    "of a task, such as \"2G\"; empty: the site's default");
  f("time", c.time, time_constraint(),
    "limit of a task, such as \"01:00:00\"; empty: the site's default");
  f("array_limit", c.array_limit, count_from(0),
    "tasks of an array that run at once; 0: as many as the cluster likes");
  f("max_array_size", c.max_array_size, count_from(0),
    "larger arrays are split; 0: the cluster is asked");
  f("task_minutes", c.task_minutes, positive(),
    "short shards are packed into tasks of about this length");
  f("refine_tasks", c.refine_tasks, between(0, kMostHelpers),
    "tasks beside a refinement's own job that simulate its rows with it, for slow simulators");
  f("signal_seconds", c.signal_seconds, between(1, 65'535),
    "before its time limit a task saves its work and is queued again");
  f("scratch", c.scratch, option_value(),
    "folder of the node for shards in the making, such as \"$TMPDIR\"; empty: none");
  f("mail", c.mail, option_value(), "address for mail when the study ends or a job fails");
  f("setup", c.setup, shell_lines(), "lines of shell before the work, such as \"module load gcc\"");
  f("sbatch", c.sbatch, options_constraint(),
    "further options of all jobs, such as \"--qos=long\"");
  const auto stage = [&](const char* key, StageResources& resources, const char* doc) {
    f.table(key, doc, [&](auto& t) { describe(t, resources); });
  };
  stage("prepare", c.prepare, "what jobs of targets and proposals ask for");
  stage("simulate", c.simulate, "what tasks that simulate ask for");
  stage("infer", c.infer, "what jobs that train ask for");
  stage("baseline", c.baseline, "what the job of the baseline asks for");
  stage("evaluate", c.evaluate, "what jobs that evaluate ask for");
  stage("diagnose", c.diagnose, "what jobs that diagnose ask for");
  stage("policy", c.policy, "what jobs that search for policies, and test them, ask for");
  stage("report", c.report, "what the job of the report asks for");
}

template <class Fields>
void describe(Fields& f, Study& c) {
  const FieldUse by_plan = {.affects = Affects::elsewhere};
  const FieldUse of_report = {.affects = Affects::report};
  f.table("study", "what the study is called and repeated over", [&](auto& t) {
    t("name", c.name, folder_name(), "names the study's folder and its report", of_report);
    t("seeds", c.seeds, seeds_constraint(),
      "one experiment each; tables report mean and standard deviation", by_plan);
  });
  f.table(
      "target", "the target domain, whose motion is explained",
      [&](auto& t) { describe(t, c.target); }, by_plan);
  f.table("simulator", "the simulator whose parameters are inferred", [&](auto& t) {
    describe(t, c.simulator, c.source());
    describe(t, c.external);
  });
  f("prior", c.prior, prior_constraint(),
    "parameter = " + marginal_words() + "; the rest stay nominal", by_plan);
  f.table("observation_noise", "noise on the simulated states that the inference sees",
          [&](auto& t) { describe(t, c.observation_noise); });
  const auto describe_simulate = [&](auto& t) {
    t("shard_size", c.simulate.shard_size, count_from(1),
      "simulations per job: what is scheduled, retried and resumed");
  };
  f.table("simulate", "how simulations are cut into jobs", describe_simulate, of_report);
  f.list("method", c.methods, 1, "a method to compare",
         [&](auto& t, auto& m) { describe(t, m, c.policy); });
  f.table(
      "evaluate", "how posteriors are judged", [&](auto& t) { describe(t, c.evaluate); }, by_plan);
  f.table("diagnose", "how posteriors are checked", [&](auto& t) { describe(t, c.diagnose); });
  f.table("policy", "search for a policy", [&](auto& t) { describe(t, c.policy); },
          {.omitted = !c.policy.is_used()});
  f.list(
      "reference", c.references, 0, "a parameter vector to compare posteriors with",
      [](auto& t, auto& r) { describe(t, r); }, by_plan);
  const auto describe_limits = [&](auto& t) {
    t("max_failed_fraction", c.limits.max_failed_fraction, between(0, 1),
      "share of failed simulations above which the study stops, with exit status 3");
  };
  f.table("limits", "when to give up", describe_limits, of_report);
  f.table(
      "report", "how results are shown", [&](auto& t) { describe(t, c.report); }, of_report);
  f.table("cluster", "how a batch system runs the study", [&](auto& t) { describe(t, c.cluster); },
          {.affects = Affects::nothing});
}

}  // namespace npdr::pipeline
