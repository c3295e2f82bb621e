#include "inference/algorithms/round_task.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "inference/algorithms/likelihood_objective.h"
#include "inference/algorithms/npe_nle.h"
#include "inference/algorithms/ratio_objective.h"
#include "inference/dequantized_features.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

std::vector<std::uint32_t> rows_of_last_round(const RoundData& data) {
  const auto last = static_cast<std::uint32_t>(data.posteriors.size() + 1);
  std::vector<std::uint32_t> rows = all_rows(data);
  std::erase_if(rows, [&](std::uint32_t row) { return data.round[row] != last; });
  return rows;
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
    // A network that says NaN of a row has not proposed it.
    proposal += share(r + 2) * numbers(log_prob - log_prior).array().exp().matrix();
  }
  return proposal.cwiseInverse().cast<float>();
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
    objective_ =
        std::make_unique<RatioObjective>(config.algorithm, network_, parts.transform, data_, id);
  }
};

}  // namespace

std::vector<std::uint32_t> all_rows(const RoundData& data) {
  std::vector<std::uint32_t> rows(data.round.size());
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

std::vector<Index> num_drawn(const RoundData& data) {
  std::vector<Index> counts = data.num_simulated;
  for (std::uint32_t r = 1; std::ssize(counts) <= std::ssize(data.posteriors); ++r) {
    counts.push_back(std::ranges::count(data.round, r));
  }
  return counts;
}

LearnedRows learned_rows(const PosteriorEstimationConfig& config, const RoundData& data,
                         bool are_pooled) {
  const Algorithm algorithm = config.algorithm.kind;
  if (algorithm == Algorithm::npe_nle) return rows_of_npe_nle(data, are_pooled);
  LearnedRows learned{.likelihood_rows = all_rows(data)};
  learned.rows = algorithm == Algorithm::npe_a ? rows_of_last_round(data) : all_rows(data);
  if (algorithm == Algorithm::npe_b) learned.weights = importance_weights(data);
  return learned;
}

std::unique_ptr<RoundTask> make_round_task(const PosteriorEstimationConfig& config,
                                           const RoundData& data, const LearnedRows& learned,
                                           const NetworkParts& parts, const StreamId& id) {
  switch (parts.role()) {
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
