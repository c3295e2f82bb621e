#include "inference/pooled_posterior.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

#include "core/error.h"
#include "core/log_sum_exp.h"
#include "inference/samplers/group_moves.h"
#include "inference/standard_normal.h"
#include "inference/weighted_moments.h"

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

// The largest 1.
Vector weights_of(const Vector& log_weights) {
  return (log_weights.array() - log_weights.maxCoeff()).exp();
}

// Those of a file may be anything.
NetworkParts checked(NetworkParts parts) {
  if (parts.role != NetworkRole::posterior) {
    throw ShapeError("pool: its networks' role is '" + std::string(name_of(parts.role)) +
                     "', must be 'posterior'");
  }
  const Index networks = parts.estimator.num_networks;
  const Index likelihoods = parts.likelihood->estimator.num_networks;
  if (likelihoods != networks) {
    throw ShapeError("pool: " + std::to_string(likelihoods) + " networks of the likelihood, must " +
                     "be " + std::to_string(networks) + ", as many as the posterior's");
  }
  return parts;
}

double log_mean_exp(const Vector& values) {
  return log_sum_exp(values) - std::log(static_cast<double>(values.size()));
}

// Rows at `count` evenly spaced places along the cumulative weights; `uniform` in (0, 1) says where
// the first is (Kitagawa 1996).
std::vector<Index> systematic_resample(const Vector& weights, Index count, double uniform) {
  const double step = weights.sum() / static_cast<double>(count);
  std::vector<Index> rows;
  double cumulative = 0.0;
  for (Index i = 0; i < weights.size(); ++i) {
    cumulative += weights(i);
    while (std::ssize(rows) < count &&
           (static_cast<double>(std::ssize(rows)) + uniform) * step < cumulative) {
      rows.push_back(i);
    }
  }
  while (std::ssize(rows) < count) rows.push_back(rows.back());  // by rounding alone
  return rows;
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
  parts.likelihood.reset();
  return parts;
}

NetworkParts likelihood_parts(NetworkParts parts) {
  parts.role = NetworkRole::likelihood;
  parts.embedding = {};
  parts.estimator = parts.likelihood->estimator;
  parts.transform = std::move(parts.likelihood->transform);
  parts.parameters = std::move(parts.likelihood->parameters);
  parts.likelihood.reset();
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

PoolEvidence PooledPosterior::evidence_of_draws(Index n, const StreamId& id) const {
  return evidence(posterior_.sample(n, id));
}

PoolPowers PooledPosterior::powers() const {
  std::call_once(known_->has_powers, [&] { known_->powers = usable_powers(); });
  return known_->powers;
}

PoolPowers PooledPosterior::usable_powers() const {
  constexpr int halvings = 20;
  const StreamId id{parts().structure_seed, "pool_powers", 0, 0, 0};
  const PoolEvidence evidence = evidence_of_draws(kCandidates, id);
  const PoolPowers wanted = parts().likelihood->powers;
  const auto part_of_way = [&](double part) {
    return PoolPowers{1.0 + part * (wanted.posterior - 1.0), part * wanted.likelihood};
  };
  const auto is_usable = [&](double part) {
    return effective_size(weights_of(evidence.log_weights(part_of_way(part)))) >=
           kSmallestEfficiency * static_cast<double>(kCandidates);
  };
  double high = 1.0, low = 0.0;
  if (is_usable(high)) return wanted;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (is_usable(middle) ? low : high) = middle;
  }
  return part_of_way(low);
}

// Draws of q with their weights.
struct PooledPosterior::Candidates {
  RowMatrix theta;  // (n, D)
  Vector log_weights;

  Index size() const { return log_weights.size(); }
  double effective_size() const { return inference::effective_size(weights_of(log_weights)); }
  double log_mean_weight() const { return log_mean_exp(log_weights); }
};

// kCandidates at a time, until `is_enough` of them or `most`.
template <typename Test>
PooledPosterior::Candidates PooledPosterior::candidates(StreamId batch, Index most,
                                                        const Test& is_enough) const {
  Candidates all{.theta = RowMatrix(0, prior().dimension()), .log_weights = {}};
  while (all.size() < most) {
    const RowMatrix more = posterior_.sample(kCandidates, batch);
    // An ensemble takes more rows of random numbers than it gives samples, and callers count
    // epochs.
    batch = within(batch, "pool_candidates");
    all.theta.conservativeResize(all.size() + more.rows(), Eigen::NoChange);
    all.theta.bottomRows(more.rows()) = more;
    all.log_weights.conservativeResize(all.theta.rows());
    all.log_weights.tail(more.rows()) = evidence(more).log_weights(powers());
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
  const Candidates drawn = candidates(first, kMostCandidates, [](const Candidates& all) {
    return all.effective_size() >= kEnough;
  });
  Group group{.theta = RowMatrix(kGroup, prior().dimension()),
              .effective_size = drawn.effective_size(),
              .num_evaluations = drawn.size(),
              .log_mean_weight = drawn.log_mean_weight()};
  Stream stream(within(id, "pool_resampling"));
  const std::vector<Index> rows =
      systematic_resample(weights_of(drawn.log_weights), kGroup, stream.uniform());
  Index place = 0;
  for (const std::uint32_t i : stream.permutation(kGroup)) {
    group.theta.row(place++) = drawn.theta.row(rows[i]);
  }
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
  RowMatrix theta(n, prior().dimension());
  SamplerReport report{.r_hat = {}, .ess = Vector::Zero(1)};
  Vector log_means((n + kGroup - 1) / kGroup);
  for (Index first = 0; first < n; first += kGroup) {
    StreamId of_group = id;
    of_group.row += static_cast<std::uint64_t>(first);
    const Group group = draw_group(of_group);
    const Index rows = std::min(kGroup, n - first);
    theta.middleRows(first, rows) = group.theta.topRows(rows);
    report.ess(0) += group.effective_size;
    report.num_evaluations += group.num_evaluations;
    log_means(first / kGroup) = group.log_mean_weight;
  }
  report.log_normalizer = log_mean_exp(log_means);
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
  const auto is_known = [](const Candidates& all) {
    const auto n = static_cast<double>(all.size());
    return n / all.effective_size() - 1.0 <= n * kNormalizerError * kNormalizerError;
  };
  return candidates(id, kMostCandidates, is_known).log_mean_weight();
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
