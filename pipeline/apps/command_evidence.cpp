// The command that lays the evidence of refined posteriors side by side: which physics, prior and
// noise explains a recording best?
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "pipeline/apps/commands.h"
#include "pipeline/apps/verdict_lines.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/observation.h"

namespace npdr::pipeline {
namespace {

struct EvidenceArguments {
  std::vector<std::string> studies;
  StudyArguments settings;  // of every study
  bool json = false;
};

// What a likelihood is the density of.
struct Data {
  std::vector<float> stored;  // states
  Index store_every = 0;
  Index segment_length = 0;  // what recorded states are given with; none: the first alone
  bool operator==(const Data&) const = default;
};

// A refined posterior of one seed.
struct Model {
  std::string study, method;
  std::uint64_t seed = 0;
  std::string physics, noise;
  Index num_parameters = 0;
  inference::ImportanceCertificate certificate;
};

struct Evidence {
  std::vector<Model> models;  // the largest log Z first
  std::optional<Data> data;   // of all of them
};

Data data_of(const Plan& plan, const Node& node) {
  const Target target = read_seen_target(plan, node);
  const sim::SimulatorConfig& simulator = plan.study.simulator;
  const bool is_cut = simulator.segment_length < target.num_steps();
  return {Observation(plan.study, target).states(), simulator.store_every,
          is_cut ? simulator.segment_length : 0};
}

// Adds the refined posteriors that a study has, and warns of their methods' failed checks: the
// evidence of a model doesn't say that it predicts what nobody has seen. All must be of the same
// data, so none of a fold.
void add_models(const Plan& plan, const std::string& file, Evidence& evidence) {
  std::set<std::string> methods;
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::infer || node.uses.front().fold > 0) continue;
    if (!std::filesystem::exists(node.path)) continue;
    const auto certificate =
        read_part<inference::ImportanceCertificate>(open_artefact(node, kPosteriorSchema));
    if (!certificate) continue;
    Data own = data_of(plan, node);
    if (evidence.data && !(*evidence.data == own)) {
      throw InputError(
          file + ", " + node.label() +
          ": explains other numbers than the posteriors before it, so their evidence can't be "
          "compared; recording, rollouts, store_every and segment_length must be the same");
    }
    evidence.data = std::move(own);
    for (const Use& use : node.uses) {
      methods.insert(use.method);
      evidence.models.push_back({.study = plan.study.name,
                                 .method = use.method,
                                 .seed = use.seed,
                                 .physics = plan.study.simulator.name,
                                 .noise = to_text(plan.study.observation_noise),
                                 .num_parameters = std::ssize(plan.study.prior),
                                 .certificate = *certificate});
    }
  }
  for (const std::string& method : methods) warn_of_failed_checks(plan, method);
  if (!methods.empty()) return;
  throw InputError(file +
                   ": has no refined posterior yet; give it a method with algorithm = "
                   "\"refine\", then 'npdr run " +
                   file + "'; what a run was given by --set must be given here, too");
}

Evidence collect(const EvidenceArguments& arguments) {
  Evidence evidence;
  for (const std::string& file : arguments.studies) {
    StudyArguments study = arguments.settings;
    study.file = file;
    add_models(study.plan(), file, evidence);
  }
  std::ranges::stable_sort(evidence.models, std::greater<>(),
                           [](const Model& m) { return m.certificate.log_evidence; });
  return evidence;
}

// The likelihood at another power has no evidence to compare.
bool counts(const Model& model) { return model.certificate.power == 1.0; }

const Model* best_of(const Evidence& evidence) {
  const auto best = std::ranges::find_if(evidence.models, counts);
  return best == evidence.models.end() ? nullptr : &*best;
}

// The scale of Kass and Raftery (1995), "Bayes factors", for the factor's logarithm.
std::string in_words(double log_factor, double error) {
  if (log_factor <= 2.0 * error) return "can't be told from the best";
  if (log_factor < 1.0) return "hardly worse than the best";
  if (log_factor < 3.0) return "positive evidence against it";
  if (log_factor < 5.0) return "strong evidence against it";
  return "very strong evidence against it";
}

std::string verdict_on(const Model& model, const Model* best) {
  const inference::ImportanceCertificate& c = model.certificate;
  if (!counts(model)) return fmt::format("likelihood to the power {:.3g}: no evidence", c.power);
  const std::string words =
      &model == best
          ? "the best"
          : in_words(best->certificate.log_evidence - c.log_evidence,
                     std::hypot(best->certificate.log_evidence_error, c.log_evidence_error));
  return inference::faults_of(c).empty() ? words : words + "; " + inference::verdict(c);
}

std::string label_of(const Model& model) {
  return fmt::format("{}: {}, {}", model.study, model.method, model.seed);
}

void print_text(const Evidence& evidence) {
  const Model* best = best_of(evidence);
  fmt::print("log Z [nats] of the same {} recorded numbers\n\n", std::ssize(evidence.data->stored));
  std::size_t width = 19, noise = 5;
  for (const Model& model : evidence.models) {
    width = std::max(width, label_of(model).size());
    noise = std::max(noise, model.noise.size());
  }
  fmt::print("{:<{}}  {:<10}  {:>10}  {:<{}}  {:>20}  {:>10}  {}\n", "study: method, seed", width,
             "physics", "parameters", "noise", noise, "log Z", "from best", "");
  for (const Model& model : evidence.models) {
    const inference::ImportanceCertificate& c = model.certificate;
    const std::string difference =
        counts(model) ? fmt::format("{:.2f}", c.log_evidence - best->certificate.log_evidence)
                      : "-";
    const std::string log_z = fmt::format("{:.2f} +- {:.2f}", c.log_evidence, c.log_evidence_error);
    fmt::print("{:<{}}  {:<10}  {:>10}  {:<{}}  {:>20}  {:>10}  {}\n", label_of(model), width,
               model.physics, model.num_parameters, model.noise, noise, log_z, difference,
               verdict_on(model, best));
  }
}

void print_as_json(const Evidence& evidence) {
  const Model* best = best_of(evidence);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Model& model : evidence.models) {
    const inference::ImportanceCertificate& c = model.certificate;
    rows.push_back({{"study", model.study},
                    {"method", model.method},
                    {"seed", model.seed},
                    {"physics", model.physics},
                    {"num_parameters", model.num_parameters},
                    {"noise", model.noise},
                    {"log_evidence", c.log_evidence},
                    {"log_evidence_error", c.log_evidence_error},
                    {"likelihood_power", c.power},
                    {"ess", c.ess},
                    {"pareto_k", c.pareto_k},
                    {"verdict", verdict_on(model, best)}});
  }
  const nlohmann::ordered_json json = {{"num_values", std::ssize(evidence.data->stored)},
                                       {"models", rows}};
  print_json(json);
}

}  // namespace

Action evidence_command(CLI::App& command) {
  auto arguments = std::make_shared<EvidenceArguments>();
  command
      .add_option("STUDY", arguments->studies,
                  "files of studies that were run, with a method of algorithm = \"refine\"; all "
                  "of the same recording")
      ->required();
  arguments->settings.add_settings_to(command);
  command.add_flag("--json", arguments->json, "for programs");
  command.footer("Example:\n  npdr evidence white.toml correlated.toml with_cable.toml");
  return [arguments] {
    const Evidence evidence = collect(*arguments);
    arguments->json ? print_as_json(evidence) : print_text(evidence);
    return ExitStatus::done;
  };
}

}  // namespace npdr::pipeline
