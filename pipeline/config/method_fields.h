/// The fields of a [[method]], with those of its embedding, network, training and sampler: a part
/// of study_fields.h, which says what a description is.
#pragma once

#include <fmt/format.h>

#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/study.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {

template <class Fields>
void describe(Fields& f, inference::EmbeddingConfig& c) {
  choice(f, "kind", c.kind,
         "how rollouts become features; where it is left out and features or average_rollouts are "
         "given, `convolution` for networks of a posterior");
  f("features", c.features, between(1, kMaxWidth),
    "width of the trained layer (\"convolution\": of the last, and \"linear\"); twice the "
    "parameters when left out, if that is more");
  f("average_rollouts", c.average_rollouts, anything<bool>(),
    "\"convolution\" only: the last layer sees the mean over rollouts, or over items of shape, not "
    "each by itself");
  f("principal_components", c.principal_components, count_from(0),
    "of the features, at most as many as there are, for the network to see; 0: the features "
    "themselves; where none of kind, features, average_rollouts and this is given, networks have "
    "four times the parameters, 20 to 50");
  f("downsample", c.downsample, count_from(1),
    "keep every k-th state; a multiple of simulator.store_every, which it is when left out");
  f("channels", c.channels, anything<std::vector<std::string>>(),
    "state channels to keep; empty: all");
  f("shape", c.shape, shape_constraint(),
    "of features, for \"convolution\": [items, steps, values], whose product is their number; "
    "[1, 32, 32]: a picture of 32 rows, [12, 1, 3]: 12 trials of three numbers, whose order is no "
    "matter with average_rollouts");
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
  std::vector<std::string> titles, flows;
  for (const auto& row : enum_table(c.kind)) {
    titles.emplace_back(row.title);
    if (row.stacks_transforms) flows.push_back(fmt::format("\"{}\"", row.name));
  }
  choice(f, "kind", c.kind, join(titles));
  f("num_networks", c.num_networks, between(c.kNumNetworks),
    "trained side by side, each from other weights and on another part of the simulations; the "
    "posterior is the mean of theirs");
  f("num_transforms", c.num_transforms, between(1, kMaxLayers),
    fmt::format("autoregressive transforms ({} only)", join(flows, " and ")));
  f("num_bins", c.num_bins, between(c.kNumBins), "bins of each spline (\"nsf\" only)");
  f("num_components", c.num_components, between(1, kMaxLayers),
    "Gaussians in the mixture (\"mdn\" only)");
  f("hidden_features", c.hidden_features, between(1, kMaxWidth), "width of each hidden layer");
  f("num_hidden_layers", c.num_hidden_layers, between(1, kMaxLayers),
    "hidden layers (per transform), or residual blocks");
}

template <class Fields>
void describe(Fields& f, inference::TrainingConfig& c) {
  f("learning_rate", c.learning_rate, interval(End::open, 0, 1, End::closed), "step size of Adam");
  f("batch_size", c.batch_size, count_from(1),
    "simulations per step of the optimizer; all that train when left out and they are fewer");
  f("validation_fraction", c.validation_fraction, interval(End::open, 0, 1, End::open),
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
  f("quantile", c.quantile, interval(End::open, 0, 1, End::closed),
    "the nearest simulations that are accepted, as a share of round 1, or for \"abc_smc\" "
    "(0.5 when left out) of the last population");
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
void describe(Fields& f, inference::LeastSquaresConfig& c) {
  f("num_candidates", c.num_candidates, between(1, 1'000'000),
    "draws of the prior that starts are chosen from");
  f("num_starts", c.num_starts, between(1, 1000), "starts that are fitted");
  f("max_simulations", c.max_simulations, count_from(1),
    "in all; of users' simulators as many as other methods make, at most, when left out");
}

template <class Fields>
void describe(Fields& f, RefineConfig& c) {
  f("start", c.start, anything<std::string>(),
    "the method whose posterior is refined; empty: begin with the prior",
    {.affects = Affects::elsewhere});
  f("likelihood_power", c.sampling.likelihood_power, interval(End::open, 0, 1, End::closed),
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

/// A table with the fields of `part`.
template <class Fields, class Part>
void table(Fields& f, const char* key, Part& part, const char* doc, const FieldUse& use = {}) {
  f.table(
      key, doc, [&](auto& t) { describe(t, part); }, use);
}

/// Use of a setting that not all algorithms read: `reads` says whether this one does.
inline FieldUse use_of_algorithm(inference::Algorithm algorithm, bool reads,
                                 Affects affects = Affects::results) {
  const std::string why = fmt::format("it means nothing to the algorithm '{}'", name_of(algorithm));
  return {.affects = affects, .unused = unless(reads, why), .settable = true};
}

template <class Fields>
void describe(Fields& f, inference::AlgorithmConfig& c) {
  using enum inference::Algorithm;
  const FieldUse of_rounds =
      use_of_algorithm(c.kind, learns_from_rounds(c.kind), Affects::elsewhere);
  choice(f, "algorithm", c.kind, "inference algorithm");
  // Each depends on all before it: more would take time and memory with their square.
  f("num_rounds", c.num_rounds, between(1, 200), "rounds of proposing, simulating and training",
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
  const auto use_of_iterations = [&](bool reads) {
    return policy.is_used() ? use_of(reads, Affects::elsewhere)
                            : FieldUse{.affects = Affects::elsewhere,
                                       .unused = " without a table [policy]",
                                       .omitted = true};
  };
  f("num_iterations", c.num_iterations, between(1, 1000),
    "with [policy]: how often rollouts are collected and a policy is searched",
    use_of_iterations(infers(c)));
  f("policy_iterations", c.policy_iterations, between(1, 100'000),
    "with [policy]: steps of each policy search", use_of_iterations(true));
  // Distances of trajectories look at no embedding.
  const bool is_embedded = family != abc || c.abc.distance == inference::AbcDistance::euclidean;
  table(f, "embedding", c.embedding, "the features that inference sees",
        use_of(learns_from_rounds(algorithm), is_embedded ? Affects::results : Affects::elsewhere));
  table(f, "density_estimator", c.density_estimator, "the network that learns the posterior",
        use_of(family == network));
  table(f, "training", c.training, "how the network is trained", use_of(family == network));
  table(f, "sampler", c.sampler, "how posteriors of a learned likelihood or ratio are sampled",
        use_of(inference::traits_of(algorithm).role != inference::NetworkRole::posterior));
  table(f, "abc", c.abc,
        "approximate Bayesian computation: \"abc_rejection\", \"abc_mcmc\", \"abc_smc\"",
        use_of(family == abc));
  table(f, "linear_regression", c.linear_regression, "the algorithm \"linear_regression\"",
        use_of(family == regression));
  FieldUse of_fits = use_of(family == fit);
  of_fits.omitted = family != fit;
  table(f, "least_squares", c.least_squares, "the algorithm \"least_squares\"", of_fits);
  FieldUse of_refinements = use_of(family == likelihood);
  of_refinements.omitted = family != likelihood;
  table(f, "refine", c.refine, "the algorithm \"refine\"", of_refinements);
  f("published", c.published, anything<std::map<std::string, PublishedFigure>>(),
    "somebody's figures to print beside ours, by metric: mean and std",
    use_of(infers(c), Affects::report));
}

}  // namespace npdr::pipeline
