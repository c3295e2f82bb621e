#include "pipeline/artefacts/posterior_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/error.h"
#include "core/text.h"
#include "inference/pooled_posterior.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"
#include "pipeline/store/hostile_json.h"

namespace npdr::pipeline {
namespace {

// Size and channels of the rollouts that x_o was made of.
struct Observed {
  double dt = 0.0;
  Index num_rollouts = 0;
  Index num_steps = 0;
  Channels channels;
};

void describe(Layout x_o, const std::string& kind, std::vector<Channel>& channels) {
  std::vector<std::string> labels, units;
  for (const Channel& channel : channels) {
    labels.push_back(channel.label);
    units.push_back(channel.unit);
  }
  x_o.attribute(kind + "_labels", labels, "of the channels of the rollouts");
  x_o.attribute(kind + "_units", units, "theirs");
  channels.clear();
  for (std::size_t c = 0; c < std::min(labels.size(), units.size()); ++c) {
    channels.push_back({labels[c], units[c]});
  }
}

void describe(Layout f, VectorF& x, Observed& observed) {
  Layout x_o = f("x_o", x, {kFeature}, "the observation, not transformed", kFinite);
  x_o.attribute("dt", observed.dt, "of the rollouts that x_o was made of [s]");
  x_o.attribute("num_rollouts", observed.num_rollouts, "how many there were");
  x_o.attribute("num_steps", observed.num_steps, "of each");
  describe(x_o, "state", observed.channels.states);
  describe(x_o, "action", observed.channels.actions);
}

void describe_proposal(Layout f, inference::GaussianMixture& proposal) {
  if (f.reads() || proposal.means.empty())
    proposal = {Vector::Zero(1), {Vector()}, {Eigen::MatrixXd()}};
  Eigen::MatrixXd& factor = proposal.precision_factors.front();
  f("mean", proposal.means.front(), {kParameter},
    "of `npe_a` after round 1: of the Gaussian that the network's answer is divided by, in the "
    "space where the prior is N(0, I)",
    kFinite);
  f("precision_factor", factor, {kParameter, kParameter},
    "U of its precision U'U, upper triangular", kFinite);
  if (f.reads()) {
    if (!(factor.diagonal().minCoeff() > 0.0)) {
      throw InputError(f.where() +
                       ": precision_factor must have a positive diagonal; rerun stage 'infer'");
    }
    factor = Eigen::MatrixXd(factor.triangularView<Eigen::Upper>());
  }
}

// What follows from the rest at x_o is there for those who read files without the program.
void describe(Layout f, PoolNotes& pool) {
  f.attribute("posterior_power", pool.powers.posterior,
              "of `npe_nle`: a of the networks above in the pool p (q / p)^a l^b, p the prior");
  f.attribute("likelihood_power", pool.powers.likelihood, "b of the networks here");
  f.attribute("posterior_power_at_x_o", pool.powers_at_x_o.posterior,
              "the same at x_o: nearer to 1 where the two contradict each other there");
  f.attribute("likelihood_power_at_x_o", pool.powers_at_x_o.likelihood, "nearer to 0");
  f.attribute("log_normalizer_at_x_o", pool.log_normalizer, "log integral of the pool [nats]");
  f.attribute("missed_share_at_x_o", pool.missed_share,
              "share of the posterior p l / Z where the pool has nothing, as q has a mode less");
  if (!f.reads()) return;
  constexpr double largest = inference::PoolPowers::kLargestSum;
  const auto [a, b] = pool.powers;
  if (a >= 0.0 && b >= 0.0 && a + b <= largest + 1e-9) return;
  throw InputError(
      f.where() + ": " +
      must_be("powers of a pool", fmt::format("{} and {}", a, b),
              fmt::format("at least 0 and {} together; rerun stage 'infer'", largest)));
}

void describe(Layout f, PoolNotes& pool, inference::PooledLikelihood& likelihood) {
  describe(f, pool);
  likelihood.powers = pool.powers;
  describe_json(f, "density_estimator", likelihood.estimator,
                "JSON: settings of the networks here");
  describe(f, likelihood.transform);
}

void describe_likelihood(Layout f, PoolNotes& pool, inference::NetworkParts& parts) {
  auto& likelihood = *std::get<inference::DirectParts>(parts.of_role).likelihood;
  describe(f, pool, likelihood);
  inference::NetworkParts networks = inference::likelihood_parts(parts);
  describe_layers(f, networks);
  likelihood.parameters = std::move(networks.parameters);
}

void describe(Layout f, inference::NetworkParts& parts, Observed& observed) {
  describe_architecture(f, parts);
  describe(f, parts.x_o, observed);
  describe(f, parts.transform);
  auto* const surrogate = std::get_if<inference::SurrogateParts>(&parts.of_role);
  inference::SamplerConfig unused;
  describe_json(f, "sampler", surrogate != nullptr ? surrogate->sampler : unused,
                "JSON: the method's table `sampler`");
  if (surrogate != nullptr) return;
  auto& proposal = std::get<inference::DirectParts>(parts.of_role).proposal;
  if (auto group = f.group("proposal", proposal)) describe_proposal(*group, *proposal);
}

// What a network's mixture says at x_o, which follows from the rest: for those who read files
// without the program.
void describe_mixture(Layout f, inference::GaussianMixture mixture) {
  const Index k = mixture.num_components(), d = mixture.dimension();
  RowMatrix means(k, d), factors(k, d * d);
  for (Index i = 0; i < k; ++i) {
    const RowMatrix factor = mixture.precision_factors[static_cast<std::size_t>(i)];
    means.row(i) = mixture.means[static_cast<std::size_t>(i)].transpose();
    factors.row(i) = Eigen::Map<const Eigen::RowVectorXd>(factor.data(), d * d);
  }
  const Dim component{"K", "component"};
  Layout group = f.group("mixture");
  group(
      "log_weight", mixture.log_weights, {component},
      "of `mdn` as a posterior: of the Gaussians at x_o, in the space where the prior is N(0, I); "
      "already divided by the proposal");
  group("mean", means, {component, kParameter}, "theirs");
  group("factor", factors, {component, kParameter, kParameter}, "U of their precisions U'U",
        {.shape = {k, d, d}});
}

void describe_embedding(Layout f, const inference::EmbeddingConfig& embedding) {
  f.attribute("embedding", to_json(embedding).dump(), "JSON: the method's table `embedding`");
}

// Losses of each network.
void describe(Layout f, std::vector<TrainingLosses>& losses) {
  Layout group = f.group("training");
  const auto there = f.reads() ? networks_there(group) : std::vector<Index>();
  if (f.reads()) losses.resize(std::max<std::size_t>(1, there.size()));
  const Dims epochs = {{"epochs", "epoch"}};
  for (std::size_t m = 0; m < losses.size(); ++m) {
    TrainingLosses& own = losses[m];
    f.forget("epochs");
    Layout network =
        group.group(group_of_network(there.empty() ? static_cast<Index>(m) : there[m]));
    network("training_loss", own.training, epochs,
            "mean of each epoch of this round's training [nats]");
    network("validation_loss", own.validation, epochs, "the same of the validation rows");
  }
}

void write_losses(Layout f, std::span<const inference::TrainingState> trainings) {
  std::vector<TrainingLosses> losses;
  for (const inference::TrainingState& state : trainings) {
    losses.push_back(
        {Vector::Map(state.training_loss.data(), std::ssize(state.training_loss)),
         Vector::Map(state.validation_loss.data(), std::ssize(state.validation_loss))});
  }
  describe(f, losses);
}

inference::NetworkParts network_parts(const std::vector<inference::Marginal>& prior) {
  return {.prior = inference::Prior(prior),
          .estimator = {},
          .transform = {},
          .parameters = {},
          .x_o = {}};
}

std::unique_ptr<inference::NetworkPosterior> read_network(const h5::File& file) {
  Layout f = Layout::reader(file);
  std::vector<inference::Marginal> prior;
  describe(f, prior);
  inference::NetworkParts parts = network_parts(prior);
  Observed observed;
  describe(f, parts, observed);
  auto* const direct = std::get_if<inference::DirectParts>(&parts.of_role);
  if (direct == nullptr && file.has("likelihood")) {
    throw InputError(fmt::format(
        "{}: pool: its networks' role is '{}', must be 'posterior'; rerun stage 'infer'",
        file.where(), name_of(parts.role())));
  }
  describe_layers(f, parts);
  if (direct != nullptr) {
    PoolNotes pool;
    auto group = f.group("likelihood", direct->likelihood);
    if (group) describe_likelihood(*group, pool, parts);
  }
  try {
    return inference::make_posterior(std::move(parts));
  } catch (const ShapeError& error) {
    throw InputError(file.where() + ": " + error.what() + "; rerun stage 'infer'");
  }
}

Observed read_observed(const std::filesystem::path& posterior) {
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  VectorF x;
  Observed observed;
  describe(Layout::reader(file), x, observed);
  return observed;
}

}  // namespace

inference::PosteriorEstimationConfig estimation_config(const MethodConfig& method,
                                                       const inference::SeriesShape& series) {
  const inference::EmbeddingConfig& embedding = method.embedding;
  inference::TrainedEmbeddingConfig trained;
  if (embedding.trains_layers()) trained.features = embedding.features;
  if (embedding.kind == inference::EmbeddingKind::convolution) {
    trained.series = series;
    if (const auto& shape = embedding.shape; !shape.empty()) {
      const auto size = [&](std::size_t i) { return static_cast<Index>(shape[i]); };
      trained.series = {size(0), size(1), size(2)};
    }
    trained.average_rollouts = embedding.average_rollouts;
  }
  return {.algorithm = method.algorithm,
          .estimator = method.density_estimator,
          .training = method.training,
          .sampler = method.sampler,
          .principal_components = method.embedding.principal_components,
          .embedding = trained};
}

void write_posterior(h5::File& file, const MethodConfig& method,
                     const inference::NetworkPosterior& posterior, const Target& target,
                     const std::vector<inference::TrainingState>& trainings, RowCounts rows,
                     std::optional<inference::UsualFeatures> usual) {
  inference::NetworkParts parts = posterior.parts();
  std::vector<inference::Marginal> prior = parts.prior.marginals();
  Observed observed{.dt = target.dt,
                    .num_rollouts = target.num_rollouts(),
                    .num_steps = target.num_steps(),
                    .channels = {target.state_channels, target.action_channels}};
  Layout f = Layout::writer(file);
  describe(f, prior);
  describe(f, parts, observed);
  describe_layers(f, parts);
  const auto* direct = dynamic_cast<const inference::DirectPosterior*>(&posterior);
  if (direct != nullptr && traits_of(parts.estimator.kind).gives(inference::Estimate::mixture)) {
    describe_mixture(f, direct->mixture());
  }
  const std::span all = trainings;
  const std::size_t networks =
      std::min(all.size(), static_cast<std::size_t>(parts.estimator.num_networks));
  write_losses(f, all.first(networks));
  if (const auto* pool = dynamic_cast<const inference::PooledPosterior*>(&posterior)) {
    Layout likelihood = f.group("likelihood");
    PoolNotes notes{parts.pooled_likelihood()->powers, pool->powers(), pool->log_normalizer(),
                    pool->missed_share()};
    describe_likelihood(likelihood, notes, parts);
    write_losses(likelihood, all.subspan(networks));
  }
  describe_embedding(f, method.embedding);
  describe(f, rows);
  describe(f, usual);
}

void describe(Layout f, std::vector<inference::Marginal>& prior) {
  std::string text = to_json(prior).dump();
  f.attribute(
      "prior", text,
      "JSON: list of `{\"name\", \"unit\", <kind>: [a, b]}`, kind as in `[prior]`, and `lower` or "
      "`upper` where one is cut off");
  if (!f.reads()) return;
  prior = prior_from_json(parse_json(text, f.where()), f.where());
  f.bind(kParameter.size, std::ssize(prior));
}

void describe(Layout f, RowCounts& rows) {
  f.attribute("num_simulations", rows.used, "rows of all rounds that have not failed");
  f.attribute("num_failed", rows.failed, "those that failed: left out, or of likelihood 0");
}

std::unique_ptr<inference::Posterior> read_posterior(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPosteriorSchema);
  if (holds_particles(file)) return read_particles(file);
  return read_network(file);
}

std::unique_ptr<inference::NetworkPosterior> read_network_posterior(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPosteriorSchema);
  if (!holds_particles(file)) return read_network(file);
  throw InputError(fmt::format(
      "{}: a posterior of '{}' has no network and holds for its own observation alone; infer from "
      "another one in a study of its own",
      file.where(), file.attribute<std::string>("algorithm")));
}

Channels observed_channels(const std::filesystem::path& posterior) {
  return read_observed(posterior).channels;
}

void require_like_observation(const std::string& where, const Target& found,
                              const std::filesystem::path& posterior) {
  constexpr double tolerance = 1e-3;
  const Observed x_o = read_observed(posterior);
  std::vector<std::string> differences;
  if (!(std::abs(found.dt - x_o.dt) <= tolerance * x_o.dt)) {
    differences.push_back(fmt::format("dt = {} s, must be {} s", found.dt, x_o.dt));
  }
  const auto require = [&](Index count, Index expected, const char* what) {
    if (count == expected) return;
    differences.push_back(fmt::format("{}, must be {}", counted(count, what), expected));
  };
  require(found.num_rollouts(), x_o.num_rollouts, "rollout");
  require(found.num_steps(), x_o.num_steps, "step");
  if (differences.empty()) return;
  throw InputError(fmt::format("{}: {}; it must be like what '{}' was trained for", where,
                               join(differences, "; "), posterior.string()));
}

PosteriorNotes read_posterior_notes(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPosteriorSchema);
  PosteriorNotes notes{.rows = {},
                       .regression = read_part<RegressionCounts>(file),
                       .certificate = read_part<inference::ImportanceCertificate>(file),
                       .losses = {},
                       .likelihood_losses = {},
                       .pool = {},
                       .powers = read_part<PowerScores>(file).value_or(PowerScores{}),
                       .residuals = read_part<sim::ErrorMemory>(file)};
  Layout f = Layout::reader(file);
  describe(f, notes.rows);
  if (auto group = f.group("likelihood", notes.pool)) {
    describe(*group, *notes.pool);
    describe(*group, notes.likelihood_losses);
  }
  if (!holds_particles(file)) describe(f, notes.losses);
  return notes;
}

void list_posterior(Layout f) {
  std::vector<inference::Marginal> prior = {{"", "", inference::Marginal::Kind::uniform, 0, 1}};
  inference::NetworkParts parts = network_parts(prior);
  Observed observed;
  RowCounts rows;
  std::vector<TrainingLosses> losses(1);
  describe(f, prior);
  describe(f, parts, observed);
  describe_mixture(f, {Vector::Zero(1), {Vector::Zero(1)}, {Eigen::MatrixXd::Ones(1, 1)}});
  PoolNotes pool;
  inference::PooledLikelihood likelihood;
  describe(f.group("likelihood"), pool, likelihood);
  describe(f.group("likelihood"), losses);
  describe_embedding(f, {});
  describe(f, rows);
  std::optional<inference::UsualFeatures> usual;
  describe(f, usual);
  describe(f, losses);
}

}  // namespace npdr::pipeline
