// Search for a policy that does well over what inference believes of the domain parameters, and its
// test.
#include <fmt/format.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "core/stop_request.h"
#include "inference/policy_search/policy_optimizer.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/predictions/policy_rollouts.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/stage_parts.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

StreamId stream_of(const Node& node, std::string_view name, Index iteration) {
  const Use& use = node.uses.front();
  return {use.seed, name, static_cast<std::uint64_t>(use.iteration), 0,
          static_cast<std::uint64_t>(iteration)};
}

// Complete domain parameters (n, P) of what the method believes. Sample i depends on i alone.
RowMatrix draw_domain_parameters(const Plan& plan, const Node& node, Index n) {
  const StreamId id = stream_of(node, "policy_domain_parameters", 0);
  const ParameterMap& parameters = plan.source->parameters();
  if (const Node* posterior = plan.find_input(node, "posterior")) {
    return parameters.complete(read_posterior(*posterior)->sample(n, id));
  }
  return parameters.complete(inference::sample_prior(inference::Prior(plan.study.prior), n, id));
}

// Parameters and states that the candidates of an iteration are tried on, the same for all.
struct Trials {
  RowMatrix theta;           // (K, P)
  RowMatrix initial_states;  // (S, C), each with every theta
};

class TrialSource {
 public:
  // Draws the samples of iterations 0 to num_iterations at once: those of some posteriors come from
  // Markov chains that have to settle first.
  TrialSource(const Plan& plan, const Node& node, const sim::PolicyTask& task, Index num_iterations)
      : node_(node), task_(task) {
    const PolicyConfig& policy = plan.study.policy;
    const Index k = policy.num_domain_parameters;
    if (plan.study.method(node.uses.front().method).algorithm.kind ==
        inference::Algorithm::nominal) {
      // One parameter vector: as many rollouts, each from an initial state of its own.
      num_states_ = k * policy.num_initial_states;
      theta_ = plan.source->parameters().nominal().transpose().replicate(num_iterations + 1, 1);
    } else {
      rows_ = k;
      num_states_ = policy.num_initial_states;
      theta_ = draw_domain_parameters(plan, node, k * (num_iterations + 1));
    }
  }

  Trials of(Index iteration) const {
    return {theta_.middleRows(iteration * rows_, rows_),
            task_.initial_states(num_states_, stream_of(node_, "policy_states", iteration))};
  }

 private:
  const Node& node_;
  const sim::PolicyTask& task_;
  Index rows_ = 1;
  Index num_states_ = 0;
  RowMatrix theta_;
};

class Search {
 public:
  Search(const Plan& plan, const Node& node)
      : plan_(plan),
        node_(node),
        checkpoints_(plan, node, kPolicyCheckpointSchema),
        num_iterations_(plan.study.method(node.uses.front().method).policy_iterations),
        task_(make_task(plan.study)),
        trials_(plan, node, *task_, num_iterations_),
        optimizer_(inference::make_policy_optimizer(plan.study.policy.search, start_point())) {}

  // Goes on from the checkpoint, where there is one. Returns the cost of the runs before.
  Cost resume() {
    const auto checkpoint = kPolicyCheckpointSchema.read_if_there(checkpoints_.file());
    if (!checkpoint) return {};
    if (!fits(*checkpoint)) {
      throw InputError(fmt::format("{}: not of this search; remove it and rerun stage 'policy'",
                                   checkpoints_.file().path.string()));
    }
    history_ = checkpoint->history;
    optimizer_ = inference::make_policy_optimizer(plan_.study.policy.search, checkpoint->optimizer);
    earlier_ = checkpoint->cost;
    return earlier_;
  }

  const PolicyHistory& run() {
    Progress progress(node_.label(), num_iterations_, history_.num_rows());
    for (Index t = history_.num_rows(); t < num_iterations_; ++t) {
      iterate(t);
      checkpoints_.save({history_, optimizer_->state(), earlier_});
      // Saved before it is shown: who looks at the progress may be gone.
      progress.update(t + 1, fmt::format("return {:.4g}", history_.mean_return(t)));
      if (stop_requested()) checkpoints_.stop();
    }
    const RowMatrix last = from_search_space(optimizer_->current().transpose());
    history_.add(last.row(0).transpose(), evaluate(last, num_iterations_), 0);
    return history_;
  }

  const sim::PolicyTaskInfo& info() const { return task_->info(); }

 private:
  Vector start_point() const {
    const Node* earlier = plan_.find_input(node_, "policy");
    const Vector policy = earlier == nullptr ? first_policy(plan_.study, task_->info())
                                             : kPolicySchema.read(*earlier).policy;
    return sim::to_search_space(task_->info(), policy.transpose()).row(0).transpose();
  }

  bool fits(const PolicyCheckpoint& checkpoint) const {
    const PolicyHistory& history = checkpoint.history;
    const inference::PolicySearchState& state = checkpoint.optimizer;
    const Index num_parameters = optimizer_->current().size(), rows = history.num_rows();
    return rows <= num_iterations_ && history.policies.cols() == num_parameters &&
           history.candidate_return.rows() == rows && state.iteration == rows &&
           state.mean.size() == num_parameters &&
           state.best_returns.size() <= plan_.study.policy.search.num_importance_samples;
  }

  RowMatrix from_search_space(const RowMatrix& points) const {
    return sim::from_search_space(task_->info(), points);
  }

  sim::PopulationValues evaluate(const RowMatrix& policies, Index iteration) {
    const Trials trials = trials_.of(iteration);
    sim::PopulationValues values =
        sim::evaluate_population(*task_, policies, trials.theta, trials.initial_states);
    const Index possible = trials.theta.rows() - values.num_impossible;
    history_.num_rollouts += policies.rows() * possible * trials.initial_states.rows();
    history_.num_impossible += values.num_impossible;
    return values;
  }

  // The current policy comes first, then the candidates.
  void iterate(Index t) {
    const RowMatrix points = optimizer_->ask(stream_of(node_, "policy_search", 0));
    const RowMatrix policies = from_search_space(points);
    const sim::PopulationValues values = evaluate(policies, t);
    history_.add(policies.row(0).transpose(), values, 0);
    history_.add_candidates(values.mean_return.tail(points.rows() - 1));
    optimizer_->tell(points, values.mean_return);
  }

  const Plan& plan_;
  const Node& node_;
  Checkpoints<PolicyCheckpoint> checkpoints_;
  Index num_iterations_;
  std::unique_ptr<sim::PolicyTask> task_;
  TrialSource trials_;
  std::unique_ptr<inference::PolicyOptimizer> optimizer_;
  PolicyHistory history_;
  Cost earlier_;
};

// Each row of theta (rows, P) from each initial state, block by block.
PolicyOutcomes try_policy(const Node& node, const sim::PolicyTask& task, const RowMatrix& theta,
                          const PolicyTest& test) {
  const Index n = test.initial_states.rows();
  Progress progress(node.label(), theta.rows() * n);
  PolicyOutcomes outcomes{RowMatrix(theta.rows(), n), RowMatrix(theta.rows(), n)};
  for (Index i = 0; i < theta.rows(); ++i) {
    stop_here_if_requested();
    const sim::PolicyRollouts rollouts = task.run(theta.row(i).replicate(n, 1), test.initial_states,
                                                  test.policy.transpose().replicate(n, 1));
    outcomes.returns.row(i) = rollouts.returns.transpose();
    for (Index s = 0; s < n; ++s) {
      const bool is_ok = std::isfinite(rollouts.returns(s));
      outcomes.success(i, s) = is_ok ? rollouts.success[static_cast<std::size_t>(s)] : kNaN;
    }
    progress.update((i + 1) * n);
  }
  return outcomes;
}

}  // namespace

template <>
void run<Stage::policy>(const Plan& plan, const Node& node, const std::vector<Index>&) {
  ArtefactWriter writer(node.path, kPolicySchema, node.identity);
  Search search(plan, node);
  writer.add_cost(search.resume());
  kPolicySchema.write(writer.file(), {.optimizer = name_of(plan.study.policy.search.kind),
                                      .history = search.run(),
                                      .parameters = policy_columns(search.info())});
  writer.finish();
}

template <>
void run<Stage::policy_test>(const Plan& plan, const Node& node, const std::vector<Index>&) {
  ArtefactWriter writer(node.path, kPolicyTestSchema, node.identity);
  const Study& study = plan.study;
  const auto task = make_task(study);
  const Node* policy = plan.find_input(node, "policy");
  PolicyTest test;
  test.policy =
      policy == nullptr ? first_policy(study, task->info()) : kPolicySchema.read(*policy).policy;
  // The same for all policies of a seed.
  test.initial_states = task->initial_states(study.policy.num_test_states,
                                             {node.uses.front().seed, "policy_test", 0, 0, 0});

  const RowMatrix theta = tested_parameters(study, *plan.source);
  const PolicyOutcomes all = try_policy(node, *task, theta, test);
  const Index num_targets = study.target.truth ? 1 : 0, num_points = theta.rows() - num_targets;
  const auto part = [&](Index begin, Index count) {
    return PolicyOutcomes{all.returns.middleRows(begin, count),
                          all.success.middleRows(begin, count)};
  };
  if (num_targets > 0) test.target = part(0, num_targets);
  if (num_points > 0) test.grid = part(num_targets, num_points);
  test.info = task->info();
  test.states = sim::make_simulator(study.simulator)->info().state_channels;
  test.axes = study.policy.grid;
  kPolicyTestSchema.write(writer.file(), std::move(test));
  writer.finish();
}

}  // namespace npdr::pipeline
