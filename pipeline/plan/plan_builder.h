/// Builds a plan: what each artefact's key is made of. Private to pipeline/plan.
#pragma once

#include <map>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// The resolved study as artefacts keep it: without what changes nothing in it, and with absolute
/// paths of libraries and models, which `npdr verify` loads from any folder.
nlohmann::ordered_json study_document(const Study& study);

/// A study's document with the names of its files alone, for keys: these count by what they hold,
/// in the keys of what is made of them, and not by where they lie as seen from the current folder.
nlohmann::ordered_json without_folders(nlohmann::ordered_json study);

class PlanBuilder {
 public:
  PlanBuilder(Study study, const WorkFolder& work, const Selection& selection);
  Plan build();

 private:
  using Inputs = std::vector<Input>;
  using Positions = std::vector<std::size_t>;  // in the plan
  using Position = std::optional<std::size_t>;

  std::size_t add_target();
  /// A target without a fold, and the rollouts that it leaves out.
  struct Fold {
    std::size_t target, left_out;
  };
  Fold add_fold(Index fold);
  std::size_t add_baseline(std::size_t target);
  /// Nodes of one inference, by round.
  struct Rounds {
    Positions simulations, posteriors;
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
  std::size_t add_policy(const MethodConfig& method, const Use& use, Position posterior,
                         Position start);
  /// Tests `policy`; none: the one that a search begins with. Returns none when there is no test.
  Position add_policy_test(const Use& use, Position policy);
  std::size_t add_proposal(const MethodConfig& method, const Use& use, Position posterior);
  std::size_t add_simulation(const MethodConfig& method, const Use& use, std::size_t target,
                             std::size_t proposal);
  std::size_t add_inference(const MethodConfig& method, const Use& use, std::size_t target,
                            const Positions& simulations, const Positions& posteriors);
  /// The posterior under the noise's likelihood, from that of another method or the prior.
  std::size_t add_fit(const MethodConfig& method, const Use& use, std::size_t target);
  Position add_held_out();
  /// Notes down in `json` what a judgment depends on, and returns its inputs.
  Inputs add_judgment(std::size_t target, Position held_out, nlohmann::ordered_json& json) const;
  std::size_t add_evaluation(const Use& use, std::size_t target, Position held_out,
                             std::size_t posterior);
  std::size_t add_diagnosis(const MethodConfig& method, const Use& use, std::size_t target,
                            const Rounds& rounds);
  void add_report(std::size_t target, std::size_t baseline);

  /// Adds a node, or another use to the node that has the same key.
  std::size_t add(Stage stage, nlohmann::ordered_json document, const Use& use,
                  const Inputs& inputs);

  Plan plan_;
  Positions evaluations_, diagnoses_, policies_, policy_tests_;
  Position held_out_;
  std::vector<Fold> folds_;
  Position scale_;  // the simulations of the prior that features are compared in units of
  SourceKeys keys_;
  Selection selection_;
  nlohmann::ordered_json study_json_;
  std::map<std::string, std::size_t> by_key_;
};

}  // namespace npdr::pipeline
