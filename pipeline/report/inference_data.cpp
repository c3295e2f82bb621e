#include "pipeline/report/inference_data.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "core/atomic_file.h"
#include "core/constants.h"
#include "inference/particle_posterior.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/process/build_info.h"
#include "pipeline/store/netcdf.h"

namespace npdr::pipeline {
namespace {

using Names = std::vector<std::string>;

// The last evaluations of a method, a chain a seed.
struct Chains {
  std::string method;
  std::vector<Index> seeds;
  std::vector<const Node*> nodes;
  std::vector<Evaluation> evaluations;

  Index num_draws() const { return evaluations.front().theta.rows(); }
};

Chains find_chains(const Plan& plan) {
  Chains chains;
  for (const auto& [node, use] : last_nodes_of_method(plan, Stage::evaluate)) {
    chains.method = use.method;
    chains.seeds.push_back(static_cast<Index>(use.seed));
    chains.nodes.push_back(node);
    chains.evaluations.push_back(kEvaluationSchema.read(*node));
  }
  return chains;
}

const Names kOfDraws = {"chain", "draw"};  // dimensions of all that a draw has one of

// A group that says who made it.
NetcdfGroup make_group(h5::File& file, const std::string& name) {
  NetcdfGroup group(file.create_group(name));
  group.attributes().set_attribute("created_at", now_utc());
  group.attributes().set_attribute("inference_library", std::string("npdr"));
  group.attributes().set_attribute("inference_library_version", creator_version());
  return group;
}

// The same with dimensions for so many draws of each seed.
NetcdfGroup make_group(h5::File& file, const std::string& name, const std::vector<Index>& seeds,
                       Index num_draws) {
  NetcdfGroup group = make_group(file, name);
  group.dimension("chain", seeds);
  std::vector<Index> draws(static_cast<std::size_t>(num_draws));
  std::iota(draws.begin(), draws.end(), Index{0});
  group.dimension("draw", draws);
  return group;
}

// What each item holds for a chain of `count` draws, one after the other: shorter ones are filled
// up.
template <class Items, class ChainOf>
std::vector<double> joined(const Items& items, Index count, double filling,
                           const ChainOf& chain_of) {
  std::vector<double> all;
  for (const auto& item : items) {
    const Vector chain = std::invoke(chain_of, item);
    all.insert(all.end(), chain.begin(), chain.end());
    all.insert(all.end(), static_cast<std::size_t>(count - chain.size()), filling);
  }
  return all;
}

// A variable for each parameter of chains whose draws are rows (n, D).
void write_parameters(NetcdfGroup& group, const Study& study, const std::vector<RowMatrix>& chains,
                      Index count) {
  Index d = 0;
  for (const inference::Marginal& marginal : study.prior) {
    const auto column = [d](const RowMatrix& theta) -> Vector { return theta.col(d); };
    group.variable(marginal.name, kOfDraws, joined(chains, count, kNaN, column), marginal.unit);
    ++d;
  }
}

void write_posterior(const Plan& plan, const Chains& chains, h5::File& file) {
  std::vector<RowMatrix> theta;
  for (const Evaluation& evaluation : chains.evaluations) theta.push_back(evaluation.theta);
  NetcdfGroup group = make_group(file, "posterior", chains.seeds, chains.num_draws());
  write_parameters(group, plan.study, theta, chains.num_draws());
}

// Particles as they are, where posteriors consist of them.
void write_weighted(const Plan& plan, const Chains& chains, h5::File& file) {
  std::vector<RowMatrix> theta;
  std::vector<Vector> log_weights;
  Index most = 0;
  for (const Node* node : chains.nodes) {
    const auto posterior = read_posterior(plan.input(*node, "posterior"));
    const auto* particles = dynamic_cast<const inference::ParticlePosterior*>(posterior.get());
    if (particles == nullptr) return;
    const Vector& weights = particles->parts().weights;
    theta.push_back(particles->parts().theta);
    log_weights.emplace_back((weights / weights.sum()).array().log());
    most = std::max(most, weights.size());
  }
  NetcdfGroup weighted = make_group(file, "weighted_posterior", chains.seeds, most);
  write_parameters(weighted, plan.study, theta, most);
  weighted.variable("log_weight", kOfDraws, joined(log_weights, most, -kInfinity, std::identity()));
}

void write_sample_stats(const Chains& chains, h5::File& file) {
  const Index n = chains.num_draws();
  NetcdfGroup stats = make_group(file, "sample_stats", chains.seeds, n);
  const auto write = [&](const std::string& name, const auto& chain_of) {
    stats.variable(name, kOfDraws, joined(chains.evaluations, n, 0.0, chain_of));
  };
  write("lp", &Evaluation::log_prob);
  for (const auto& [name, values] : chains.evaluations.front().metrics) {
    write(name, [&name = name](const Evaluation& e) { return e.metrics.at(name); });
  }
}

void write_prior(const Plan& plan, h5::File& file, Index num_draws) {
  const inference::Prior prior(plan.study.prior);
  NetcdfGroup group = make_group(file, "prior", {0}, num_draws);
  write_parameters(group, plan.study, {sample_prior(prior, num_draws, {0, "export", 0, 0, 0})},
                   num_draws);
}

// Dimensions of rollouts. Time is that of the state after each step.
void describe_rollouts(NetcdfGroup& group, const Target& target) {
  Names names;
  for (const Rollout& rollout : target.rollouts) names.push_back(rollout.name);
  group.dimension("rollout", names);
  std::vector<double> time;
  for (Index t = 1; t <= target.num_steps(); ++t) {
    time.push_back(static_cast<double>(t) * target.dt);
  }
  group.dimension("time", time).set_attribute("units", std::string("s"));
}

void describe_features(NetcdfGroup& group, const Target& x_o) {
  Names names;
  for (const Channel& feature : x_o.state_channels) names.push_back(feature.label);
  group.dimension("feature", names);
}

// What a source without motion gave at the draws.
void write_predicted_features(const Chains& chains, const Target& x_o, h5::File& file) {
  NetcdfGroup group = make_group(file, "posterior_predictive", chains.seeds, chains.num_draws());
  describe_features(group, x_o);
  std::vector<float> values;
  for (const Evaluation& evaluation : chains.evaluations) {
    values.insert(values.end(), evaluation.x->data(), evaluation.x->data() + evaluation.x->size());
  }
  group.variable("x", {"chain", "draw", "feature"}, values);
}

void write_predicted_rollouts(const Plan& plan, const Chains& chains, const Predictor& predictor,
                              h5::File& file, Index num_draws) {
  std::vector<sim::Trajectories> rollouts;
  for (std::size_t c = 0; c < chains.nodes.size(); ++c) {
    const Use& use = chains.nodes[c]->uses.front();
    const RowMatrix theta = chains.evaluations[c].theta.topRows(num_draws);
    rollouts.push_back(
        predictor.simulate(plan.source->parameters().complete(theta),
                           {use.seed, "external_prediction", use.stream_round(), 0, 0}));
  }
  const Target& target = predictor.target();
  NetcdfGroup group = make_group(file, "posterior_predictive", chains.seeds, num_draws);
  group.attributes().set_attribute("comment", std::string("without observation noise"));
  describe_rollouts(group, target);
  const auto stride = static_cast<std::size_t>(target.num_states());
  for (std::size_t c = 0; c < stride; ++c) {
    std::vector<float> values;
    for (const sim::Trajectories& one : rollouts) {
      for (std::size_t i = c; i < one.values.size(); i += stride) values.push_back(one.values[i]);
    }
    group.variable(target.state_channels[c].label, {"chain", "draw", "rollout", "time"}, values,
                   target.state_channels[c].unit);
  }
}

// A variable for each channel: a column of what `rows_of` takes from a rollout, (T) rows.
template <class RowsOf>
void write_channels(NetcdfGroup& group, const Target& target, const std::vector<Channel>& channels,
                    const RowsOf& rows_of) {
  describe_rollouts(group, target);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto column = [&](const Rollout& rollout) -> Vector {
      return rows_of(rollout).col(static_cast<Index>(c));
    };
    group.variable(channels[c].label, {"rollout", "time"},
                   joined(target.rollouts, target.num_steps(), kNaN, column), channels[c].unit);
  }
}

void write_observed(const Target& target, bool gives_motion, h5::File& file) {
  NetcdfGroup observed = make_group(file, "observed_data");
  if (!gives_motion) {
    describe_features(observed, target);
    const auto x_o = target.rollouts.front().states.row(1);
    observed.variable("x", {"feature"}, std::vector<double>(x_o.begin(), x_o.end()));
    return;
  }
  write_channels(observed, target, target.state_channels,
                 [](const Rollout& r) -> RowMatrix { return r.states.bottomRows(r.num_steps()); });
  NetcdfGroup constant = make_group(file, "constant_data");
  constant.variable("dt", {}, std::vector<double>{target.dt}, "s");
  write_channels(constant, target, target.action_channels,
                 [](const Rollout& r) { return r.actions; });
}

// Predictions, and what was observed.
void write_rollouts(const Plan& plan, const Chains& chains, h5::File& file, Index num_predictions) {
  const SourceTraits& traits = plan.study.source();
  const Judge judge(plan, *chains.nodes.front());
  const Target& target = judge.seen().target();
  const Index num_draws = std::min(num_predictions, chains.num_draws());
  if (traits.simulates && num_draws > 0) {
    traits.gives_motion ? write_predicted_rollouts(plan, chains, judge.seen(), file, num_draws)
                        : write_predicted_features(chains, target, file);
  }
  write_observed(target, traits.gives_motion, file);
}

}  // namespace

void write_inference_data(const Plan& plan, const std::filesystem::path& path,
                          Index num_predictions) {
  const Chains chains = find_chains(plan);
  AtomicFile atomic(path);
  h5::File file = h5::File::create(atomic.temporary(), path);
  file.set_attribute("study", plan.study.name);
  file.set_attribute("method", chains.method);
  write_posterior(plan, chains, file);
  write_weighted(plan, chains, file);
  write_sample_stats(chains, file);
  write_prior(plan, file, chains.num_draws());
  write_rollouts(plan, chains, file, num_predictions);
  file.close();
  atomic.commit();
}

}  // namespace npdr::pipeline
