/// The plan of a study: every artefact that it needs, with its key, in an order in which they can
/// be made. Keys follow from the study and the keys of the inputs, so the whole plan is known
/// before anything has run.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/enum_names.h"
#include "core/target.h"
#include "pipeline/artefacts/work_folder.h"
#include "pipeline/config/study.h"
#include "pipeline/sources/source.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// The stages, in the order in which they run.
enum class Stage {
  target,
  held_out,
  propose,
  simulate,
  infer,
  baseline,
  evaluate,
  diagnose,
  policy,
  policy_test,
  report
};

/// A stage's name, the executable that makes its artefacts, the part of [cluster] that its jobs ask
/// for.
struct StageTraits : EnumRow<Stage> {
  std::string_view program;
  StageResources ClusterConfig::*resources;
  bool uses_threads = true;  ///< more than one is worth while
};

constexpr auto enum_table(Stage) {
  using enum Stage;
  using C = ClusterConfig;
  return std::to_array<StageTraits>({{{target, "target"}, "npdr-propose", &C::prepare, false},
                                     {{held_out, "held_out"}, "npdr-propose", &C::prepare, false},
                                     {{propose, "propose"}, "npdr-propose", &C::prepare, false},
                                     {{simulate, "simulate"}, "npdr-simulate", &C::simulate},
                                     {{infer, "infer"}, "npdr-infer", &C::infer, false},
                                     {{baseline, "baseline"}, "npdr-evaluate", &C::baseline},
                                     {{evaluate, "evaluate"}, "npdr-evaluate", &C::evaluate},
                                     {{diagnose, "diagnose"}, "npdr-diagnose", &C::diagnose},
                                     {{policy, "policy"}, "npdr-policy", &C::policy},
                                     {{policy_test, "policy_test"}, "npdr-policy", &C::policy},
                                     {{report, "report"}, "npdr-report", &C::report, false}});
}

constexpr StageTraits traits_of(Stage stage) { return row_of(stage); }

/// Who uses an artefact: methods that share prior, budget and seed share simulations.
struct Use {
  std::string method = {};  ///< "": the whole study
  std::uint64_t seed = 0;
  /// Counted from 1; 0: none, or, of proposals and simulations, that of calibration.
  Index round = 0;
  /// Iteration of the loop of target rollouts, inference and policy search, counted from 1. 0: what
  /// comes before the first policy search, and whatever a method without such a loop infers.
  Index iteration = 0;
  /// Fold of the rollouts that is left out (evaluate.leave_out), counted from 1; 0: none is.
  Index fold = 0;
  friend bool operator==(const Use&, const Use&) = default;

  /// Names the random numbers of a round: each round of each iteration has its own.
  std::uint64_t stream_round() const;
};

/// An input of an artefact.
struct Input {
  std::string name;      ///< such as "posterior", or "simulation_2": that of round 2
  std::size_t position;  ///< in the plan
};

/// Name of the input that is one of several: "posterior_2".
std::string numbered(std::string_view name, Index number);

/// One artefact of the plan.
struct Node : ArtefactFile {
  Stage stage = Stage::target;
  Identity identity;
  std::vector<Use> uses;           ///< at least one; the first made it part of the plan
  std::vector<Input> inputs;       ///< those that its key depends on
  std::vector<std::size_t> needs;  ///< positions in the plan of all, which are before this one

  /// Name for people: "simulate NPDR (MAF), seed 1, iteration 3, round 2"; "infer NPE, seed 1,
  /// round 1, without fold 2".
  std::string label() const;
};

/// Which part of a study is meant; empty: all.
struct Selection {
  std::vector<std::string> methods;
  std::vector<std::uint64_t> seeds;
};

struct Plan {
  Study study;
  std::shared_ptr<const Source> source;  ///< of its rows
  WorkFolder work;
  /// The recording, held-out rollouts last, or x_o; empty for a simulated truth.
  Target target;
  /// Those of the recording, whether or not the simulator is given them.
  std::vector<Channel> recorded_actions;
  std::vector<std::string> words;  ///< that name the study to a program: file, --set, ...
  std::vector<Node> nodes;

  /// The command that makes all of it, for people; empty without words.
  std::string command() const;
  /// The node of a stage for one use. Throws InputError when there is none.
  const Node& node(Stage stage, const Use& use) const;
  /// The node whose key begins with `key`. Throws InputError when there is none or more than one.
  const Node& node_by_key(const std::string& key) const;
  /// The input of `node` with that name; nullptr: it has none.
  const Node* find_input(const Node& node, std::string_view name) const;
  /// The same of one that it has. Throws Error.
  const Node& input(const Node& node, std::string_view name) const;
  /// Its inputs "name_1", "name_2", ..., in their order.
  std::vector<const Node*> inputs(const Node& node, std::string_view name) const;
};

/// Makes the artefact of a stage (pipeline/stages/stages.h); of a simulation the shards with these
/// numbers (empty: all) and, once all are there, the artefact that joins them. Each stage
/// specializes it beside what it does: one without doesn't link.
template <Stage stage>
void run(const Plan& plan, const Node& node, const std::vector<Index>& shard_numbers);

/// Plans `study`. Reads the recording, if there is one: its content is part of every key. Throws
/// InputError for a bad recording or a selection that names what isn't there.
Plan make_plan(Study study, const WorkFolder& work, const Selection& selection = {});

/// The link of a use of `node` in the study's readable folder.
std::filesystem::path link_of(const Plan& plan, const Node& node, const Use& use);

/// The file that what a job says of `node` goes to, in the study's readable folder.
std::filesystem::path log_of(const Plan& plan, const Node& node);

/// Makes the links of all uses of a complete artefact. Throws Error.
void link_uses(const Plan& plan, const Node& node);

/// Rollouts of `seen` in a fold: every evaluate.leave_out-th from the fold's own number on, counted
/// from 1. Throws InputError for fold 0, which has none.
Target of_fold(const Study& study, const Target& seen, Index fold);
/// Those that aren't in it; all for fold 0.
Target without_fold(const Study& study, const Target& seen, Index fold);

/// Whether a node proposes or simulates what posteriors are calibrated with.
bool is_calibration(const Node& node);

/// Whether a node is a posterior that simulates by itself: a refinement.
bool is_refinement(const Plan& plan, const Node& node);
/// Whether the node infers from simulations that it asks for itself.
bool simulates(const Plan& plan, const Node& node);

/// The simulations of a node's round.
Index num_rows(const Plan& plan, const Node& node);

/// Target rollouts that a method's node of that use sees, those of earlier iterations first; 0:
/// all.
Index num_rollouts_seen(const MethodConfig& method, const Use& use);

}  // namespace npdr::pipeline
