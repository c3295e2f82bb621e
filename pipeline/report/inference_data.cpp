#include "pipeline/report/inference_data.h"

#include <algorithm>
#include <functional>

#include "core/atomic_file.h"
#include "core/constants.h"
#include "inference/particle_posterior.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/report/inference_chains.h"

namespace npdr::pipeline {
namespace {

using Chain = std::vector<double>;  // values of one chain's draws

Chain chain_of(const Eigen::Ref<const Vector>& values) { return {values.begin(), values.end()}; }

// Chains of `count` draws, one after the other: shorter ones are filled up.
template <class T, class ChainOf>
Chain joined(const std::vector<T>& chains, Index count, double filling, const ChainOf& chain_of) {
  Chain all;
  for (const T& one : chains) {
    const Chain values = chain_of(one);
    all.insert(all.end(), values.begin(), values.end());
    all.insert(all.end(), static_cast<std::size_t>(count) - values.size(), filling);
  }
  return all;
}

// A variable for each parameter of chains that have their draws in rows of `theta`, (n, D).
template <class T>
void write_parameters(NetcdfGroup& group, const std::vector<inference::Marginal>& prior,
                      const std::vector<T>& chains, Index count) {
  for (std::size_t d = 0; d < prior.size(); ++d) {
    const auto column = [&](const T& one) {
      return chain_of(one.theta.col(static_cast<Index>(d)));
    };
    group.variable(prior[d].name, kOfDraws, joined(chains, count, kNaN, column), prior[d].unit);
  }
}

// Particles as they are, where posteriors consist of them.
void write_weighted(const Plan& plan, const Chains& chains, h5::File& file) {
  std::vector<inference::ParticleParts> parts;
  Index most = 0;
  for (const Node* node : chains.nodes) {
    const auto posterior = read_posterior(plan.input(*node, "posterior"));
    const auto* particles = dynamic_cast<const inference::ParticlePosterior*>(posterior.get());
    if (particles == nullptr) return;
    parts.push_back(particles->parts());
    most = std::max(most, parts.back().theta.rows());
  }
  NetcdfGroup weighted = make_group(file, "weighted_posterior", chains.seeds, most);
  write_parameters(weighted, plan.study.prior, parts, most);
  weighted.variable("log_weight", kOfDraws,
                    joined(parts, most, -kInfinity, [](const inference::ParticleParts& part) {
                      return chain_of((part.weights / part.weights.sum()).array().log());
                    }));
}

void write_sample_stats(const Chains& chains, h5::File& file) {
  const Index n = chains.num_draws();
  NetcdfGroup stats = make_group(file, "sample_stats", chains.seeds, n);
  const auto write = [&](const std::string& name, const auto& chain_of_evaluation) {
    stats.variable(name, kOfDraws, joined(chains.evaluations, n, 0.0, chain_of_evaluation));
  };
  write("lp", [](const Evaluation& e) { return chain_of(e.log_prob); });
  for (const auto& [name, values] : chains.evaluations.front().metrics) {
    write(name, [&](const Evaluation& e) { return chain_of(e.metrics.at(name)); });
  }
}

void write_prior(const Plan& plan, h5::File& file, Index num_draws) {
  struct Draws {
    RowMatrix theta;
  };
  const inference::Prior prior(plan.study.prior);
  const std::vector<Draws> chain = {{sample_prior(prior, num_draws, {0, "export", 0, 0, 0})}};
  NetcdfGroup group = make_group(file, "prior", {0}, num_draws);
  write_parameters(group, plan.study.prior, chain, num_draws);
}

}  // namespace

void write_inference_data(const Plan& plan, const std::filesystem::path& path,
                          Index num_predictions) {
  const Chains chains = find_chains(plan);
  AtomicFile atomic(path);
  h5::File file = h5::File::create(atomic.temporary(), path);
  file.set_attribute("study", plan.study.name);
  file.set_attribute("method", chains.method);
  NetcdfGroup posterior = make_group(file, "posterior", chains.seeds, chains.num_draws());
  write_parameters(posterior, plan.study.prior, chains.evaluations, chains.num_draws());
  write_weighted(plan, chains, file);
  write_sample_stats(chains, file);
  write_prior(plan, file, chains.num_draws());
  write_rollouts(plan, chains, file, num_predictions);
  file.close();
  atomic.commit();
}

}  // namespace npdr::pipeline
