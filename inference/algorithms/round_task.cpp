#include "inference/algorithms/round_task.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "inference/algorithms/likelihood_objective.h"
#include "inference/algorithms/pool_powers.h"
#include "inference/algorithms/ratio_objective.h"
#include "inference/dequantized_features.h"
#include "inference/truncated_prior.h"

namespace npdr::inference {
namespace {

std::vector<std::uint32_t> all_rows(const RoundData& data) {
  std::vector<std::uint32_t> rows(data.round.size());
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

std::vector<std::uint32_t> rows_of_last_round(const RoundData& data) {
  const auto last = static_cast<std::uint32_t>(data.posteriors.size() + 1);
  std::vector<std::uint32_t> rows = all_rows(data);
  std::erase_if(rows, [&](std::uint32_t row) { return data.round[row] != last; });
  return rows;
}

// Rows that each round has drawn; those that failed count, too: what rows are draws of is the
// mixture of what was drawn, whichever of it is left.
std::vector<Index> num_drawn(const RoundData& data) {
  std::vector<Index> counts = data.num_simulated;
  for (std::uint32_t r = 1; std::ssize(counts) <= std::ssize(data.posteriors); ++r) {
    counts.push_back(std::ranges::count(data.round, r));
  }
  return counts;
}

// w = p(theta) / p~(theta), with p~ the mixture of all that the rounds were drawn from, in
// proportion to their rows (Veach and Guibas 1995, the balance heuristic): bounded by N / N_1,
// however far a proposal is from the prior.
VectorF importance_weights(const RoundData& data) {
  if (data.posteriors.empty()) return {};
  const Vector log_prior = data.prior->log_prob(data.theta);
  const std::vector<Index> counts = num_drawn(data);
  const auto total = static_cast<double>(std::reduce(counts.begin(), counts.end()));
  const auto share = [&](std::size_t round) {
    return static_cast<double>(counts[round - 1]) / total;
  };
  Vector proposal = Vector::Constant(log_prior.size(), share(1));  // over the prior's density
  for (std::size_t r = 0; r < data.posteriors.size(); ++r) {
    const Vector log_prob = data.posteriors[r]->log_prob(data.theta);
    proposal += share(r + 2) * (log_prob - log_prior).array().exp().matrix();
  }
  return proposal.cwiseInverse().cast<float>();
}

Index num_of_last_round(const std::vector<std::uint32_t>& rows, const RoundData& data) {
  const auto last = static_cast<std::uint32_t>(data.posteriors.size() + 1);
  return std::ranges::count_if(rows, [&](std::uint32_t row) { return data.round[row] == last; });
}

// Takes those that judge from the rows that are learned from: the last of the last round.
void take_judging_rows(LearnedRows& learned, Index num_new) {
  const Index count = std::min(num_judging_rows(std::ssize(learned.rows)), num_new);
  learned.judging.assign(learned.rows.end() - count, learned.rows.end());
  learned.rows.resize(learned.rows.size() - learned.judging.size());
  std::erase_if(learned.likelihood_rows, [&](std::uint32_t row) {
    return std::ranges::binary_search(learned.judging, row);
  });
}

// Those of the last of the regions R_2, ..., R_r. Round j has drawn N_j rows of the prior within
// R_j, whose share of the prior is Z_j, so that at u there are
//   N_1 + sum_j 1[u in R_j] N_j / Z_j
// of them for each of the prior's; of N_r rows that judge don't count. w is one over that, with a
// mean of 1. Where regions lie within each other all are the same.
LearnedRows rows_of_last_region(const RoundData& data, bool are_judged) {
  const std::vector<Index> drawn = num_drawn(data);
  Vector density = Vector::Constant(data.theta.rows(), static_cast<double>(drawn.front()));
  LearnedRows learned{.likelihood_rows = all_rows(data)};
  for (std::size_t j = 1; j <= data.posteriors.size(); ++j) {
    const TruncatedPrior region(*data.posteriors[j - 1]);
    const std::vector<std::uint32_t> within = region.rows_within(data.theta);
    auto count = static_cast<double>(drawn[j]);
    if (j == data.posteriors.size()) {
      const Index num_new = num_of_last_round(within, data);
      learned.rows = within;
      if (are_judged) take_judging_rows(learned, num_new);
      const Index num_learned = num_new - std::ssize(learned.judging);
      if (num_new > 0) count *= static_cast<double>(num_learned) / static_cast<double>(num_new);
    }
    density(within).array() += count / region.prior_mass();
  }
  const Vector weights = density.cwiseInverse();
  const double mean = learned.rows.empty() ? 1.0 : weights(learned.rows).mean();
  learned.weights = (weights / mean).cast<float>();
  return learned;
}

std::vector<GaussianMixture> proposal_mixtures(const RoundData& data) {
  std::vector<GaussianMixture> mixtures;
  for (const auto& posterior : data.posteriors) mixtures.push_back(proposal_mixture(*posterior));
  return mixtures;
}

// A network, what it trains on, and an objective that refers to both.
template <class Network>
class TaskOf : public RoundTask {
 public:
  TaskOf(Network network, const RoundData& data, const NetworkParts& parts)
      : network_(std::move(network)),
        data_{data.x, parts.prior.to_normal(data.theta).cast<float>(), data.round, {}} {}
  TaskOf(const TaskOf&) = delete;

  Objective& objective() override { return *objective_; }
  Index num_parameters() const override { return network_.num_parameters(); }
  Parameters<float> initial_parameters(const StreamId& id) const override {
    return network_.initial_parameters(id);
  }

 protected:
  Network network_;
  TrainingData data_;
  std::unique_ptr<Objective> objective_;
};

class PosteriorTask : public TaskOf<EmbeddedEstimator<float>> {
 public:
  PosteriorTask(const PosteriorEstimationConfig& config, const RoundData& data,
                const LearnedRows& learned, const NetworkParts& parts, const StreamId& id)
      : TaskOf(make_network(parts), data, parts) {
    if (config.algorithm.kind != Algorithm::npe_c) {
      objective_ = std::make_unique<LikelihoodObjective>(LikelihoodObjective::Of::u_given_z,
                                                         network_, parts.transform, data_,
                                                         learned.rows, learned.weights);
      return;
    }
    if (is_analytic(config.algorithm, config.estimator.kind)) {
      data_.proposals = proposal_mixtures(data);
    }
    objective_ = std::make_unique<NpeC>(config.algorithm, network_, parts.transform, data_, id);
  }
};

class LikelihoodTask : public TaskOf<EmbeddedEstimator<float>> {
 public:
  LikelihoodTask(const RoundData& data, const std::vector<std::uint32_t>& rows,
                 const NetworkParts& parts)
      : TaskOf(make_network(parts), data, parts), features_(*data.x, parts.structure_seed) {
    data_.x = &features_;
    objective_ = std::make_unique<LikelihoodObjective>(LikelihoodObjective::Of::z_given_u, network_,
                                                       parts.transform, data_, rows, VectorF());
  }

 private:
  DequantizedFeatures features_;
};

class RatioTask : public TaskOf<RatioEstimator<float>> {
 public:
  RatioTask(const PosteriorEstimationConfig& config, const RoundData& data,
            const NetworkParts& parts, const StreamId& id)
      : TaskOf({parts.estimator, parts.prior.dimension(), parts.transform.num_outputs()}, data,
               parts) {
    const bool is_binary = config.algorithm.kind == Algorithm::nre_a;
    objective_ = std::make_unique<RatioObjective>(is_binary, config.algorithm.num_atoms, network_,
                                                  parts.transform, data_, id);
  }
};

}  // namespace

LearnedRows learned_rows(const PosteriorEstimationConfig& config, const RoundData& data,
                         bool are_judged) {
  const Algorithm algorithm = config.algorithm.kind;
  if (algorithm == Algorithm::npe_nle && !data.posteriors.empty()) {
    return rows_of_last_region(data, are_judged);
  }
  LearnedRows learned{.likelihood_rows = all_rows(data)};
  learned.rows = algorithm == Algorithm::npe_a ? rows_of_last_round(data) : all_rows(data);
  if (algorithm == Algorithm::npe_b) learned.weights = importance_weights(data);
  if (are_judged) take_judging_rows(learned, num_of_last_round(learned.rows, data));
  return learned;
}

std::unique_ptr<RoundTask> make_round_task(const PosteriorEstimationConfig& config,
                                           const RoundData& data, const LearnedRows& learned,
                                           const NetworkParts& parts, const StreamId& id) {
  switch (parts.role) {
    case NetworkRole::posterior:
      return std::make_unique<PosteriorTask>(config, data, learned, parts, id);
    case NetworkRole::likelihood:
      return std::make_unique<LikelihoodTask>(data, learned.likelihood_rows, parts);
    case NetworkRole::ratio:
      break;
  }
  return std::make_unique<RatioTask>(config, data, parts, id);
}

}  // namespace npdr::inference
