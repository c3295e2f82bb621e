/// Builds a plan: what each artefact's key is made of. Private to pipeline/plan.
#pragma once

#include <map>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

class PlanBuilder {
 public:
  PlanBuilder(Study study, const WorkFolder& work, const Selection& selection);
  Plan build();

 private:
  using Inputs = std::vector<Input>;

  std::size_t add_target();
  /// A target without a fold, and the rollouts that it leaves out.
  struct Fold {
    std::size_t target;
    std::size_t left_out;
  };
  Fold add_fold(Index fold);
  std::size_t add_baseline(std::size_t target);
  /// Nodes that the report needs.
  struct Results {
    std::vector<std::size_t> evaluations;
    std::vector<std::size_t> diagnoses;
    std::vector<std::size_t> policies;
    std::vector<std::size_t> policy_tests;
  };
  /// Nodes of one inference, by round.
  struct Rounds {
    std::vector<std::size_t> simulations;
    std::vector<std::size_t> posteriors;
  };
  /// All iterations of one method and seed.
  void add_experiment(const MethodConfig& method, std::uint64_t seed, std::size_t target);
  /// The method and seed again, without each fold of the rollouts.
  void add_folds(const MethodConfig& method, std::uint64_t seed);
  /// All rounds of one iteration.
  Rounds add_rounds(const MethodConfig& method, Use use, std::size_t target);
  /// Adds evaluations and checks of the posteriors of the last iteration.
  void add_judgments(const MethodConfig& method, Use use, std::size_t target,
                     std::size_t first_target, const Rounds& rounds);
  /// The rollouts of `earlier`, and those that `policy` collects.
  std::size_t add_collection(const MethodConfig& method, const Use& use, std::size_t earlier,
                             std::size_t policy);
  /// `posterior`: none of a method that infers nothing. `start`: the last iteration's policy.
  std::size_t add_policy(const MethodConfig& method, const Use& use,
                         std::optional<std::size_t> posterior, std::optional<std::size_t> start);
  /// Tests `policy`; none: the one that a search begins with. Returns none when there is no test.
  std::optional<std::size_t> add_policy_test(const Use& use, std::optional<std::size_t> policy);
  std::size_t add_proposal(const MethodConfig& method, const Use& use,
                           std::optional<std::size_t> posterior);
  std::size_t add_simulation(const MethodConfig& method, const Use& use, std::size_t target,
                             std::size_t proposal);
  std::size_t add_inference(const MethodConfig& method, const Use& use, std::size_t target,
                            const std::vector<std::size_t>& simulations,
                            const std::vector<std::size_t>& posteriors);
  /// The posterior under the noise's likelihood, from that of another method or the prior.
  std::size_t add_refinement(const MethodConfig& method, const Use& use, std::size_t target);
  std::optional<std::size_t> add_held_out();
  /// The simulations of the prior that features are compared in units of.
  std::size_t add_scale();
  /// Notes down in `json` what a judgment depends on, and returns its inputs.
  Inputs add_judgment(std::size_t target, std::optional<std::size_t> held_out,
                      nlohmann::ordered_json& json) const;
  std::size_t add_evaluation(const Use& use, std::size_t target,
                             std::optional<std::size_t> held_out, std::size_t posterior);
  std::size_t add_diagnosis(const MethodConfig& method, const Use& use, std::size_t target,
                            const Rounds& rounds);
  void add_report(std::size_t target, std::size_t baseline);

  /// Adds a node, or another use to the node that has the same key.
  std::size_t add(Stage stage, nlohmann::ordered_json document, const Use& use,
                  const Inputs& inputs);

  Plan plan_;
  Results results_;
  std::optional<std::size_t> held_out_;
  std::vector<Fold> folds_;
  std::optional<std::size_t> scale_;
  SourceKeys keys_;
  Selection selection_;
  nlohmann::ordered_json study_json_;
  std::map<std::string, std::size_t> by_key_;
};

}  // namespace npdr::pipeline
