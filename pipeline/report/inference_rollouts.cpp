#include <algorithm>

#include "pipeline/predictions/judge.h"
#include "pipeline/report/inference_chains.h"

namespace npdr::pipeline {
namespace {

// Time is that of the state after each step.
void describe_rollouts(NetcdfGroup& group, const Target& target) {
  std::vector<std::string> names;
  for (const Rollout& rollout : target.rollouts) names.push_back(rollout.name);
  group.dimension("rollout", names);
  std::vector<double> time;
  for (Index t = 1; t <= target.num_steps(); ++t)
    time.push_back(static_cast<double>(t) * target.dt);
  group.dimension("time", time).set_attribute("units", std::string("s"));
}

void describe_features(NetcdfGroup& group, const Target& x_o) {
  std::vector<std::string> names;
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

std::vector<sim::Trajectories> simulate(const Plan& plan, const Chains& chains,
                                        const Predictor& predictor, Index num_draws) {
  std::vector<sim::Trajectories> rollouts;
  for (std::size_t c = 0; c < chains.nodes.size(); ++c) {
    const Use& use = chains.nodes[c]->uses.front();
    const RowMatrix theta = chains.evaluations[c].theta.topRows(num_draws);
    rollouts.push_back(
        predictor.simulate(plan.source->parameters().complete(theta),
                           {use.seed, "external_prediction", use.stream_round(), 0, 0}));
  }
  return rollouts;
}

void write_predicted_rollouts(const Plan& plan, const Chains& chains, const Predictor& predictor,
                              h5::File& file, Index num_draws) {
  const Target& target = predictor.target();
  const auto rollouts = simulate(plan, chains, predictor, num_draws);
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
    std::vector<double> values;
    for (const Rollout& rollout : target.rollouts) {
      const Vector column = rows_of(rollout).col(static_cast<Index>(c));
      values.insert(values.end(), column.begin(), column.end());
    }
    group.variable(channels[c].label, {"rollout", "time"}, values, channels[c].unit);
  }
}

}  // namespace

void write_rollouts(const Plan& plan, const Chains& chains, h5::File& file, Index num_predictions) {
  const SourceTraits& traits = plan.study.source();
  const Judge judge(plan, *chains.nodes.front());
  const Target& target = judge.seen().target();
  const Index num_draws = std::min(num_predictions, chains.num_draws());
  if (traits.simulates && num_draws > 0) {
    traits.gives_motion ? write_predicted_rollouts(plan, chains, judge.seen(), file, num_draws)
                        : write_predicted_features(chains, target, file);
  }
  NetcdfGroup observed = make_group(file, "observed_data");
  if (!traits.gives_motion) {
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

}  // namespace npdr::pipeline
