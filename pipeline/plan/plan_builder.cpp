#include "pipeline/plan/plan_builder.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/check.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {
namespace {

// More than any study that ends within a life; each takes about 200 KB of memory.
constexpr Index kMostInferences = 5000;

using Json = nlohmann::ordered_json;

std::filesystem::path path_of(const Plan& plan, Stage stage, const std::string& key) {
  if (stage == Stage::report) return plan.work.study(plan.study.name) / "report.json";
  return plan.work.artefact(name_of(stage), key);
}

// The settings of a method that a posterior depends on, whatever the method is called and however
// many rounds follow.
Json inference_json(const MethodConfig& method) {
  Json json = key_json(method);
  // Raised when their bits change, which leaves the keys of other posteriors as they are.
  constexpr int correction_version = 2, pool_version = 4, fit_version = 2;
  const bool is_corrected = inference::is_analytic(method.algorithm, method.density_estimator.kind);
  if (is_corrected) json["correction_version"] = correction_version;
  if (method.algorithm.kind == inference::Algorithm::npe_nle) json["pool_version"] = pool_version;
  if (family_of(method) == inference::AlgorithmFamily::fit) json["fit_version"] = fit_version;
  if (family_of(method) == inference::AlgorithmFamily::likelihood) {
    json["refinement_version"] = kRefinementCheckpointSchema.version;
  }
  return json;
}

// Methods that differ only in what changes no posterior share what is made of them.
void note(std::vector<std::size_t>& nodes, std::size_t added) {
  if (std::ranges::find(nodes, added) == nodes.end()) nodes.push_back(added);
}

// Adds inputs "name_1", "name_2", ..., without those before `first`.
void add_numbered(std::string_view name, const std::vector<std::size_t>& nodes,
                  std::vector<Input>& inputs, std::size_t first = 0) {
  for (std::size_t i = first; i < nodes.size(); ++i) {
    inputs.push_back({numbered(name, static_cast<Index>(i) + 1), nodes[i]});
  }
}

std::optional<std::size_t> last_of(const std::vector<std::size_t>& nodes) {
  return nodes.empty() ? std::nullopt : std::optional(nodes.back());
}

template <class T>
bool is_among(const std::vector<T>& selected, const T& value) {
  return selected.empty() || std::ranges::find(selected, value) != selected.end();
}

void check_selection(const Study& study, const Selection& selection) {
  for (const std::string& name : selection.methods) study.method(name);
  for (const std::uint64_t seed : selection.seeds) {
    if (is_among(study.seeds, seed)) continue;
    throw InputError(
        fmt::format("seed {} is not among study.seeds = [{}]", seed, fmt::join(study.seeds, ", ")));
  }
}

// Before anything is built: what inferences depend on grows with the square of their rounds.
void check_size(const Study& study, const Selection& selection) {
  Index of_a_seed = 0;
  for (const MethodConfig& method : study.methods) {
    if (!is_among(selection.methods, method.name)) continue;
    const Index repeats = study.num_iterations_of(method) + study.evaluate.leave_out;
    of_a_seed += method.algorithm.num_rounds * repeats;
  }
  const auto num_seeds = std::ssize(selection.seeds.empty() ? study.seeds : selection.seeds);
  if (of_a_seed * num_seeds <= kMostInferences) return;
  throw InputError(fmt::format(
      "{}: its seeds, methods, iterations, rounds and folds ask for {} inferences, must be at most "
      "{}; lower method.num_rounds, or divide study.seeds among several studies",
      study.name, of_a_seed * num_seeds, kMostInferences));
}

// Describes how predictions are scored.
void describe_scoring(const Study& study, Json& json) {
  if (!study.source().gives_motion) return;
  json["store_every"] = study.simulator.store_every;
  json["observation_noise"] = key_json(study.observation_noise);
}

}  // namespace

PlanBuilder::PlanBuilder(Study study, const WorkFolder& work, const Selection& selection)
    : plan_{std::move(study), nullptr, work, {}, {}, {}, {}}, selection_(selection) {
  check_selection(plan_.study, selection);
  check_size(plan_.study, selection);
  if (auto x_o = resolve_source(plan_.study)) plan_.target = std::move(*x_o);
  plan_.source = make_source(plan_.study);
  keys_ = plan_.source->keys();
  study_json_ = study_document(plan_.study);
}

Plan PlanBuilder::build() {
  const std::size_t target = add_target();
  held_out_ = add_held_out();
  for (Index fold = 1; fold <= plan_.study.evaluate.leave_out; ++fold) {
    folds_.push_back(add_fold(fold));
  }
  if (plan_.study.source().predicts_features()) {
    const MethodConfig& method = plan_.study.methods.front();
    const Use use{method.name, plan_.study.seeds.front(), 1};
    scale_ = add_simulation(method, use, 0, add_proposal(method, use, std::nullopt));
  }
  for (const std::uint64_t seed : plan_.study.seeds) {
    if (!is_among(selection_.seeds, seed)) continue;
    // The first answer: what is ready is started in the order of the nodes.
    const MethodConfig* fit = plan_.study.floor_method();
    if (fit && is_among(selection_.methods, fit->name)) add_rounds(*fit, {fit->name, seed}, target);
    for (const MethodConfig& method : plan_.study.methods) {
      if (!is_among(selection_.methods, method.name)) continue;
      add_experiment(method, seed, target);
      if (infers(method)) add_folds(method, seed);
    }
  }
  add_report(target, add_baseline(target));
  return std::move(plan_);
}

// Describes what baselines and posteriors are measured by.
PlanBuilder::Inputs PlanBuilder::add_judgment(std::size_t target, Position held_out,
                                              Json& json) const {
  json["simulator"] = keys_.states;
  json["metrics"] = to_names(plan_.study.evaluate.metrics);
  const GoalConfig& goal = plan_.study.external.goal;
  if (goal.radius > 0.0) json["goal"] = {goal.place, goal.radius, goal.speed};
  for (const ReferenceConfig& reference : plan_.study.references) {
    json["references"][reference.name] = reference.parameters;
  }
  Inputs inputs = {{"target", target}};
  if (held_out) inputs.push_back({"held_out", *held_out});
  if (scale_) inputs.push_back({"prior_predictive", *scale_});
  return inputs;
}

std::size_t PlanBuilder::add_baseline(std::size_t target) {
  Json json = key_document(kBaselineSchema);
  Inputs inputs = add_judgment(target, held_out_, json);
  if (plan_.study.source().simulates) json["num_samples"] = plan_.study.evaluate.num_samples;
  describe_scoring(plan_.study, json);
  json["prior"] = to_json(plan_.study.prior);
  if (plan_.study.target.recording) json["floor"] = plan_.study.evaluate.floor;
  if (const MethodConfig* fit = plan_.study.floor_method()) {
    const Rounds rounds = add_rounds(*fit, {fit->name, plan_.study.seeds.front()}, target);
    inputs.push_back({"posterior", rounds.posteriors.back()});
  }
  return add(Stage::baseline, json, {}, inputs);
}

void PlanBuilder::add_experiment(const MethodConfig& method, std::uint64_t seed,
                                 std::size_t target) {
  const Index num_iterations = plan_.study.num_iterations_of(method);
  std::size_t seen = target;
  std::optional<std::size_t> policy;
  for (Index i = 1; i <= num_iterations; ++i) {
    const Use use{method.name, seed, 0, num_iterations > 1 ? i : 0};
    if (i > 1) seen = add_collection(method, use, seen, *policy);
    const Rounds rounds = infers(method) ? add_rounds(method, use, seen) : Rounds{};
    if (i == num_iterations && infers(method)) {
      add_judgments(method, use, seen, target, rounds);
    }
    if (!plan_.study.policy.is_used()) continue;
    policy = add_policy(method, {method.name, seed, 0, i}, last_of(rounds.posteriors), policy);
    note(policies_, *policy);
  }
  if (!policy) return;
  for (const Index i : {Index{0}, num_iterations}) {
    const auto tested = i == 0 ? std::nullopt : policy;
    const auto test = add_policy_test({method.name, seed, 0, i}, tested);
    if (test) note(policy_tests_, *test);
  }
}

void PlanBuilder::add_folds(const MethodConfig& method, std::uint64_t seed) {
  Use use{.method = method.name, .seed = seed};
  for (const Fold& fold : folds_) {
    ++use.fold;
    use.round = 0;
    const Rounds rounds = add_rounds(method, use, fold.target);
    use.round = method.algorithm.num_rounds;
    note(evaluations_, add_evaluation(use, fold.target, fold.left_out, rounds.posteriors.back()));
  }
}

PlanBuilder::Rounds PlanBuilder::add_rounds(const MethodConfig& method, Use use,
                                            std::size_t target) {
  Rounds rounds;
  using enum inference::AlgorithmFamily;
  if (family_of(method) == likelihood || family_of(method) == fit) {
    use.round = 1;
    rounds.posteriors.push_back(add_fit(method, use, target));
    return rounds;
  }
  for (use.round = 1; use.round <= method.algorithm.num_rounds; ++use.round) {
    if (learns(method)) {
      const std::size_t proposal = add_proposal(method, use, last_of(rounds.posteriors));
      rounds.simulations.push_back(add_simulation(method, use, target, proposal));
    }
    rounds.posteriors.push_back(
        add_inference(method, use, target, rounds.simulations, rounds.posteriors));
  }
  return rounds;
}

// Evaluations measure by the rollouts that all methods have seen first, which makes them
// comparable; diagnoses ask about the observation that the posteriors are of.
void PlanBuilder::add_judgments(const MethodConfig& method, Use use, std::size_t target,
                                std::size_t first_target, const Rounds& rounds) {
  const bool all_rounds = plan_.study.evaluate.rounds == EvaluatedRounds::all;
  const Index last = method.algorithm.num_rounds;
  for (use.round = all_rounds ? 1 : last; use.round <= last; ++use.round) {
    const std::size_t posterior = rounds.posteriors[static_cast<std::size_t>(use.round - 1)];
    note(evaluations_, add_evaluation(use, first_target, held_out_, posterior));
  }
  if (plan_.study.diagnose_of(method).of_diagnosis().checks.empty()) return;
  use.round = 0;
  note(diagnoses_, add_diagnosis(method, use, target, rounds));
}

std::size_t PlanBuilder::add_proposal(const MethodConfig& method, const Use& use,
                                      Position posterior) {
  Json json = key_document(kProposalSchema);
  json["num_simulations"] =
      use.round == 0 ? plan_.study.diagnose.num_simulations : method.algorithm.num_simulations;
  json["seed"] = use.seed;
  json["round"] = use.round;
  if (use.iteration > 1) json["iteration"] = use.iteration;
  json.update(keys_.theta);
  if (!posterior) json["prior"] = to_json(plan_.study.prior);
  return add(Stage::propose, json, use, posterior ? Inputs{{"posterior", *posterior}} : Inputs{});
}

std::size_t PlanBuilder::add_simulation(const MethodConfig& method, const Use& use,
                                        std::size_t target, std::size_t proposal) {
  Json json = key_document(kSimulationSchema);
  json["simulator"] = keys_.rows;
  Inputs inputs;
  // Features don't depend on the target: with another x_o, the simulations of the prior stay.
  if (plan_.study.source().gives_motion) {
    json["num_rollouts"] = method.num_rollouts;
    inputs.push_back({"target", target});
  }
  inputs.push_back({"proposal", proposal});
  return add(Stage::simulate, json, use, inputs);
}

std::size_t PlanBuilder::add_inference(const MethodConfig& method, const Use& use,
                                       std::size_t target, const Positions& simulations,
                                       const Positions& posteriors) {
  Json json = key_document(kPosteriorSchema);
  const inference::AlgorithmTraits& algorithm = inference::traits_of(method.algorithm.kind);
  json.update(inference_json(method));
  const bool is_abc = algorithm.family == inference::AlgorithmFamily::abc;
  const bool compares_trajectories =
      is_abc && method.abc.distance != inference::AbcDistance::euclidean;
  if (!learns(method)) {
    const sim::SimulatorConfig& known = plan_.study.simulator;
    json["simulator"] = {{"name", known.name}, {"parameters", known.parameters}};
    json["prior"] = to_json(plan_.study.prior);
  } else if (!compares_trajectories) {
    json["observation_noise"] = to_json(plan_.study.observation_noise);
  }
  json["seed"] = use.seed;
  json["round"] = use.round;
  if (use.iteration > 1) json["iteration"] = use.iteration;
  if (algorithm.grows_in_last_round) json["is_last"] = use.round == method.algorithm.num_rounds;
  Inputs inputs = {{"target", target}};
  // A population has all that matters of the rounds before it.
  add_numbered("simulation", simulations, inputs, is_abc ? simulations.size() - 1 : 0);
  add_numbered("posterior", posteriors, inputs,
               is_abc && !posteriors.empty() ? posteriors.size() - 1 : 0);
  return add(Stage::infer, json, use, inputs);
}

std::size_t PlanBuilder::add_fit(const MethodConfig& method, const Use& use, std::size_t target) {
  Json json = key_document(kPosteriorSchema);
  json.update(inference_json(method));
  json["simulator"] = keys_.rows;
  json["prior"] = to_json(plan_.study.prior);
  json["observation_noise"] = key_json(plan_.study.observation_noise);
  json["seed"] = use.seed;
  if (use.iteration > 1) json["iteration"] = use.iteration;
  Inputs inputs = {{"target", target}};
  if (!method.refine.start.empty()) {
    const MethodConfig& start = plan_.study.method(method.refine.start);
    const Use first{start.name, use.seed, 0, use.iteration, use.fold};
    const Rounds rounds = add_rounds(start, first, target);
    inputs.push_back({numbered("posterior", 1), rounds.posteriors.back()});
  }
  return add(Stage::infer, json, use, inputs);
}

std::size_t PlanBuilder::add_evaluation(const Use& use, std::size_t target, Position held_out,
                                        std::size_t posterior) {
  Json json = key_document(kEvaluationSchema);
  Inputs inputs = add_judgment(target, held_out, json);
  inputs.push_back({"posterior", posterior});
  json["num_samples"] = plan_.study.evaluate.num_samples;
  describe_scoring(plan_.study, json);
  if (plan_.study.target.truth) json["truth"] = *plan_.study.target.truth;
  json["seed"] = use.seed;
  return add(Stage::evaluate, json, use, inputs);
}

// Calibration asks the network of round 1, which has learned from the whole prior; what concerns
// x_o alone, that of the last round.
std::size_t PlanBuilder::add_diagnosis(const MethodConfig& method, const Use& use,
                                       std::size_t target, const Rounds& rounds) {
  Json json = key_document(kDiagnosisSchema);
  const DiagnoseConfig diagnose = plan_.study.diagnose_of(method).of_diagnosis();
  json.update(key_json(diagnose));
  json["simulator"] = keys_.rows;
  json["embedding"] = to_json(method.embedding);
  json["num_rollouts"] = method.num_rollouts;
  json["observation_noise"] = to_json(plan_.study.observation_noise);
  json["seed"] = use.seed;
  Inputs inputs = {{"target", target}, {"posterior", rounds.posteriors.back()}};
  if (diagnose.calibrates()) {
    if (rounds.posteriors.size() > 1)
      inputs.push_back({numbered("posterior", 1), rounds.posteriors.front()});
    const std::size_t proposal = add_proposal(method, use, {});
    inputs.push_back({"calibration", add_simulation(method, use, target, proposal)});
  }
  if (diagnose.has(Check::ood) || diagnose.has(Check::failures)) {
    add_numbered("simulation", rounds.simulations, inputs);
  }
  return add(Stage::diagnose, json, use, inputs);
}

void PlanBuilder::add_report(std::size_t target, std::size_t baseline) {
  Json json = key_document(kReportSchema);
  json["study"] = without_folders(study_json_);
  Inputs inputs = {{"baseline", baseline}};
  add_numbered("evaluation", evaluations_, inputs);
  add_numbered("diagnosis", diagnoses_, inputs);
  add_numbered("policy", policies_, inputs);
  add_numbered("policy_test", policy_tests_, inputs);
  const std::size_t report = add(Stage::report, json, {}, inputs);
  // It shows of the targets and posteriors, too, which may be gone while evaluations are there.
  std::vector<std::size_t>& needs = plan_.nodes[report].needs;
  note(needs, target);
  if (held_out_) note(needs, *held_out_);
  for (const Fold& fold : folds_) {
    note(needs, fold.target);
    note(needs, fold.left_out);
  }
  for (const std::size_t evaluation : evaluations_) {
    for (const std::size_t need : plan_.nodes[evaluation].needs) note(needs, need);
  }
}

std::size_t PlanBuilder::add(Stage stage, Json document, const Use& use, const Inputs& inputs) {
  Node node;
  node.stage = stage;
  for (const auto& [name, position] : inputs) {
    node.identity.inputs[name] = plan_.nodes[position].key;
    node.needs.push_back(position);
  }
  node.inputs = inputs;
  document["inputs"] = node.identity.inputs;
  node.identity.key_document = std::move(document);
  node.identity.study = study_json_;
  node.identity.seed = use.seed;
  node.key = node.identity.key();
  if (const auto known = by_key_.find(node.key); known != by_key_.end()) {
    std::vector<Use>& uses = plan_.nodes[known->second].uses;
    if (std::ranges::find(uses, use) == uses.end()) uses.push_back(use);
    return known->second;
  }
  node.path = path_of(plan_, stage, node.key);
  node.uses = {use};
  by_key_[node.key] = plan_.nodes.size();
  plan_.nodes.push_back(std::move(node));
  return plan_.nodes.size() - 1;
}

}  // namespace npdr::pipeline
