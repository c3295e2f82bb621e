// Commands that compare posteriors: sets of samples (compare), evidences of refined ones
// (evidence).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/feature_names.h"
#include "core/printable.h"
#include "inference/diagnostics/c2st.h"
#include "inference/diagnostics/mmd.h"
#include "inference/diagnostics/two_samples.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/observation.h"

namespace npdr::pipeline {
namespace {

struct CompareArguments {
  std::string first, second;
  std::vector<std::string> datasets = {"theta"};  ///< one for both, or one for each
  Index most_rows = 10'000;
  std::uint64_t seed = 0;
  bool json = false;
};

struct Comparison {
  SampleSet first, second;
  inference::C2st c2st;
  inference::Mmd mmd;
};

Comparison compare(const CompareArguments& arguments) {
  const StreamId id{arguments.seed, "compare_rows", 0, 0, 0};
  SampleSet first =
      read_sample_set(arguments.first, arguments.datasets.front(), arguments.most_rows, id);
  SampleSet second = in_order_of(
      first, read_sample_set(arguments.second, arguments.datasets.back(), arguments.most_rows, id));
  for (const SampleSet* set : {&first, &second}) {
    if (set->rows.rows() >= inference::kFewestRowsOfSample) continue;
    throw InputError(fmt::format("{}: {} rows, must be at least {}", set->where, set->rows.rows(),
                                 inference::kFewestRowsOfSample));
  }
  const Index n = std::min({arguments.most_rows, first.rows.rows(), second.rows.rows()});
  for (SampleSet* set : {&first, &second}) {
    set->rows = set->rows(spread_positions(n, set->rows.rows(), id), Eigen::all).eval();
  }
  const inference::C2st c2st =
      inference::c2st(first.rows, second.rows, {arguments.seed, "c2st", 0, 0, 0});
  const inference::Mmd mmd =
      inference::mmd(first.rows, second.rows, {arguments.seed, "mmd", 0, 0, 0});
  return {std::move(first), std::move(second), c2st, mmd};
}

// Calls visit(name, moments of the first, of the second).
template <class Visit>
void for_each_column(const Comparison& c, const Visit& visit) {
  const auto& names = c.first.columns.empty() ? c.second.columns : c.first.columns;
  const auto first = inference::column_moments(c.first.rows);
  const auto second = inference::column_moments(c.second.rows);
  for (std::size_t d = 0; d < first.size(); ++d) {
    visit(names.empty() ? Channel{fmt::format("column {}", d + 1), "1"} : names[d], first[d],
          second[d]);
  }
}

void print_as_json(const Comparison& c) {
  nlohmann::ordered_json json = {
      {"first", c.first.where},
      {"second", c.second.where},
      {"num_rows", c.first.rows.rows()},
      {"num_repeated_rows",
       {inference::num_repeated_rows(c.first.rows), inference::num_repeated_rows(c.second.rows)}},
      {"c2st", {{"accuracy", c.c2st.accuracy}, {"standard_error", c.c2st.standard_error}}},
      {"mmd",
       {{"squared", c.mmd.squared}, {"p_value", c.mmd.p_value}, {"bandwidth", c.mmd.bandwidth}}}};
  for_each_column(c, [&](const Channel& name, const auto& a, const auto& b) {
    json["parameters"].push_back({{"name", name.label},
                                  {"unit", name.unit},
                                  {"first", {{"mean", a.mean}, {"std", a.deviation}}},
                                  {"second", {{"mean", b.mean}, {"std", b.deviation}}}});
  });
  print_json(json);
}

// A classifier knows rows that it has been taught, and a posterior of weighted particles repeats
// them.
void warn_of_repeats(const SampleSet& set, const char* name) {
  constexpr double many = 0.02;
  const Index repeats = inference::num_repeated_rows(set.rows);
  if (static_cast<double>(repeats) < many * static_cast<double>(set.rows.rows())) return;
  fmt::print(
      "warning: {} of the {} rows picked of {} are copies of others, which C2ST takes for a "
      "difference: take fewer (-n), or draws that are all different\n",
      repeats, set.rows.rows(), name);
}

void print_text(const Comparison& c) {
  print_line("first   {}", c.first.where);
  print_line("second  {}", c.second.where);
  fmt::print("{} rows of each, picked at random where it has more\n", c.first.rows.rows());
  warn_of_repeats(c.first, "the first");
  warn_of_repeats(c.second, "the second");
  fmt::print(
      "\nC2ST   {:.4f} ± {:.4f}  (0.5: can't be told apart, 1: don't overlap; far below 0.5: "
      "rows are in both)\n",
      c.c2st.accuracy, c.c2st.standard_error);
  fmt::print("MMD^2  {:.3g}, p = {:.2g}  (p: as large by chance, when both are the same)\n\n",
             c.mmd.squared, c.mmd.p_value);
  fmt::print("{:<28} {:>11} {:>11} {:>11} {:>11}\n", "", "mean first", "mean second", "std first",
             "std second");
  for_each_column(c, [](const Channel& name, const auto& a, const auto& b) {
    fmt::print("{:<28} {:>11.4g} {:>11.4g} {:>11.4g} {:>11.4g}\n",
               printable_line(feature_name(name)), a.mean, b.mean, a.deviation, b.deviation);
  });
}

struct EvidenceArguments {
  std::vector<std::string> studies;
  StudyArguments settings;  // of every study
  bool json = false;
};

// Recorded numbers that a likelihood is the density of.
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
  return inference::faults_of(c).empty() ? words : words + "; sampling " + inference::verdict(c);
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
  print_json({{"num_values", std::ssize(evidence.data->stored)}, {"models", rows}});
}

}  // namespace

Action compare_command(CLI::App& command) {
  auto arguments = std::make_shared<CompareArguments>();
  command
      .add_option("FIRST", arguments->first,
                  "HDF5 with a dataset (rows, parameters), such as evaluate.h5, or CSV")
      ->required();
  command.add_option("SECOND", arguments->second, "the same")->required();
  command
      .add_option("--dataset", arguments->datasets,
                  "of the HDF5 files: one name for both, or one for each")
      ->expected(1, 2)
      ->capture_default_str();
  command.add_option("-n,--num-samples", arguments->most_rows, "rows of each, at most")
      ->capture_default_str()
      ->check(CLI::Range(inference::kFewestRowsOfSample, Index{1'000'000}));
  add_seed_option(command, "--seed", arguments->seed);
  command.add_flag("--json", arguments->json, "for programs");
  command.footer("Example:\n  npdr compare mine.csv runs/study/npe/seed-1/round-1/evaluate.h5");
  return done_after([arguments] {
    const Comparison comparison = compare(*arguments);
    arguments->json ? print_as_json(comparison) : print_text(comparison);
  });
}

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
  return done_after([arguments] {
    const Evidence evidence = collect(*arguments);
    arguments->json ? print_as_json(evidence) : print_text(evidence);
  });
}

}  // namespace npdr::pipeline
