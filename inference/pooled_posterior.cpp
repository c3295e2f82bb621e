#include "inference/pooled_posterior.h"

#include <cmath>
#include <mutex>
#include <string>

#include "core/error.h"
#include "core/log_sum_exp.h"
#include "inference/missed_share.h"
#include "inference/samplers/group_moves.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

// Samples are resampled in groups, from as many candidates as give twice as many effective ones.
constexpr Index kGroup = 500;
constexpr double kEnough = 2.0 * kGroup;        // effective ones
constexpr Index kCandidates = 4 * kGroup;       // drawn at once
constexpr Index kMostCandidates = 64 * kGroup;  // of a group
constexpr Index kMoves = 30;                    // where those weren't enough

constexpr double kNormalizerError = 0.02;  // [nats], where the most candidates allow it

constexpr double kImpossible = -1e100;

constexpr PoolPowers kPosteriorAlone = {};

// Parts that a file holds may be anything.
NetworkParts checked(NetworkParts parts) {
  const Index networks = parts.estimator.num_networks;
  const Index likelihoods = parts.pooled_likelihood()->estimator.num_networks;
  if (likelihoods != networks) {
    throw ShapeError("pool: " + std::to_string(likelihoods) + " networks of the likelihood, must " +
                     "be " + std::to_string(networks) + ", as many as the posterior's");
  }
  return parts;
}

}  // namespace

Vector PoolEvidence::log_weights(PoolPowers powers) const {
  const Vector log_l = likelihood.array().isFinite().select(likelihood.array(), kImpossible);
  const Vector weights = (powers.posterior - 1.0) * posterior + powers.likelihood * log_l;
  return posterior.array().isFinite().select(weights, kImpossible);
}

// Written once, by whoever needs it first.
struct PooledPosterior::Known {
  std::once_flag has_powers, has_normalizer;
  PoolPowers powers;
  double log_z = 0.0;
};

NetworkParts posterior_parts(NetworkParts parts) {
  std::get<DirectParts>(parts.of_role).likelihood.reset();
  return parts;
}

NetworkParts likelihood_parts(NetworkParts parts) {
  PooledLikelihood likelihood = *std::move(std::get<DirectParts>(parts.of_role).likelihood);
  parts.of_role = role_parts(NetworkRole::likelihood);
  parts.estimator = likelihood.estimator;
  parts.transform = std::move(likelihood.transform);
  parts.parameters = std::move(likelihood.parameters);
  return parts;
}

PooledPosterior::PooledPosterior(NetworkParts given)
    : NetworkPosterior(checked(std::move(given))),
      posterior_(posterior_parts(parts())),
      likelihood_(likelihood_parts(parts())),
      known_(std::make_unique<Known>()) {}

PooledPosterior::~PooledPosterior() = default;

PoolEvidence PooledPosterior::evidence(const RowMatrix& theta, const Vector& log_q) const {
  const Vector log_prior = prior().log_prob(theta);
  return {log_q - log_prior, likelihood_.relative_log_prob(theta) - log_prior};
}

PoolEvidence PooledPosterior::evidence(const RowMatrix& theta) const {
  return evidence(theta, posterior_.log_prob(theta));
}

PoolPowers PooledPosterior::powers() const {
  std::call_once(known_->has_powers, [&] { known_->powers = usable_powers(); });
  return known_->powers;
}

PoolPowers PooledPosterior::usable_powers() const {
  constexpr int halvings = 20;
  const StreamId id{parts().structure_seed, "pool_powers", 0, 0, 0};
  const RowMatrix draws = posterior_.sample(kCandidates, id);
  const PoolEvidence evidence = this->evidence(draws);
  const PoolPowers wanted = parts().pooled_likelihood()->powers;
  const auto part_of_way = [&](double part) {
    return PoolPowers{1.0 + part * (wanted.posterior - 1.0), part * wanted.likelihood};
  };
  const auto is_usable = [&](double part) {
    return WeightedPopulation(draws, evidence.log_weights(part_of_way(part))).effective_size() >=
           kSmallestEfficiency * static_cast<double>(kCandidates);
  };
  const double part = largest_power(0.0, 1.0, is_usable, halvings);
  return part == 1.0 ? wanted : part_of_way(part);
}

// kCandidates at a time, until `is_enough` of them or kMostCandidates.
template <typename Test>
WeightedPopulation PooledPosterior::candidates(StreamId batch, const Test& is_enough) const {
  WeightedPopulation all(prior().dimension());
  while (all.size() < kMostCandidates) {
    const RowMatrix more = posterior_.sample(kCandidates, batch);
    // An ensemble takes more rows of random numbers than it gives samples, and callers count
    // epochs.
    batch = within(batch, "pool_candidates");
    all.append({more, evidence(more).log_weights(powers())});
    if (is_enough(all)) break;
  }
  return all;
}

struct PooledPosterior::Group {
  RowMatrix theta;  // (kGroup, D)
  double effective_size = 0.0;
  Index num_evaluations = 0;
  double log_mean_weight = 0.0;
};

PooledPosterior::Group PooledPosterior::draw_group(const StreamId& id) const {
  StreamId first = within(id, "pool_candidates");
  first.row = id.row * (kMostCandidates / kGroup);
  const WeightedPopulation drawn = candidates(
      first, [](const WeightedPopulation& all) { return all.effective_size() >= kEnough; });
  Stream stream(within(id, "pool_resampling"));
  Group group{.theta = drawn.resampled(kGroup, stream),
              .effective_size = drawn.effective_size(),
              .num_evaluations = drawn.size(),
              .log_mean_weight = drawn.log_mean_weight()};
  if (group.effective_size < kEnough) {
    move(group.theta, stream);
    group.num_evaluations += (1 + kMoves) * kGroup;
  }
  return group;
}

// Draws that repeat each other walk apart.
void PooledPosterior::move(RowMatrix& theta, Stream& stream) const {
  RowMatrix u = prior().to_normal(theta);
  const auto log_density = [&](const RowMatrix& at) -> Vector {
    const PoolEvidence here = evidence(prior().to_theta(at));
    return log_standard_normal(at) + here.posterior + here.log_weights(powers());
  };
  move_group(u, log_density, kMoves, stream);
  theta = prior().to_theta(u);
}

Samples PooledPosterior::draw(Index n, const StreamId& id) const {
  if (n == 0 || powers() == kPosteriorAlone) return posterior_.draw(n, id);
  SamplerReport report{.r_hat = {}, .ess = Vector::Zero(1)};
  std::vector<double> log_means;
  const auto draw_one = [&](const StreamId& of_group) {
    Group group = draw_group(of_group);
    report.ess(0) += group.effective_size;
    report.num_evaluations += group.num_evaluations;
    log_means.push_back(group.log_mean_weight);
    return std::move(group.theta);
  };
  const RowMatrix theta = draw_in_groups(n, kGroup, prior().dimension(), id, draw_one);
  report.log_normalizer =
      log_mean_exp(Eigen::Map<const Vector>(log_means.data(), std::ssize(log_means)));
  return {theta, report};
}

double PooledPosterior::log_normalizer() const {
  std::call_once(known_->has_normalizer, [&] { known_->log_z = estimate_log_normalizer(); });
  return known_->log_z;
}

double PooledPosterior::estimate_log_normalizer() const {
  if (powers() == kPosteriorAlone) return 0.0;
  const StreamId id{parts().structure_seed, "pool_normaliser", 0, 0, 0};
  // The squared relative error of a mean of n weights is (n / effective size - 1) / n.
  const auto is_known = [](const WeightedPopulation& all) {
    const auto n = static_cast<double>(all.size());
    return n / all.effective_size() - 1.0 <= n * kNormalizerError * kNormalizerError;
  };
  return candidates(id, is_known).log_mean_weight();
}

double PooledPosterior::missed_share() const {
  if (powers() == kPosteriorAlone) return 0.0;
  const StreamId id{parts().structure_seed, "pool_missed", 0, 0, 0};
  const double log_z = log_normalizer();
  return inference::missed_share(
      prior().to_normal(sample(kGroup, id)),
      [&](const RowMatrix& u) -> ComparedDensities {
        PoolEvidence here = evidence(prior().to_theta(u));
        return {here.posterior + here.log_weights(powers()) - Vector::Constant(u.rows(), log_z),
                std::move(here.likelihood)};
      },
      id);
}

Vector PooledPosterior::relative_log_prob(const RowMatrix& theta) const {
  const Vector log_q = posterior_.log_prob(theta);
  if (powers() == kPosteriorAlone) return log_q;
  // Outside of the prior's support both are -infinity, whose difference means nothing.
  const Vector pooled = log_q + evidence(theta, log_q).log_weights(powers());
  return log_q.array().isFinite().select(pooled, log_q);
}

Vector PooledPosterior::log_prob(const RowMatrix& theta) const {
  return relative_log_prob(theta).array() - log_normalizer();
}

}  // namespace npdr::inference
