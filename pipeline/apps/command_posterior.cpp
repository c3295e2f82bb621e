// Commands that use a trained posterior: sample and log-prob.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "analysis/escape.h"
#include "core/error.h"
#include "core/log_sum_exp.h"
#include "core/printable.h"
#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "inference/diagnostics/two_samples.h"
#include "inference/embeddings/embedding.h"
#include "inference/samplers/chain_diagnostics.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/verdict_lines.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/sample_set.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/usual_features_file.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"
#include "pipeline/findings/findings.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/store/hostile_json.h"
#include "pipeline/store/number_table.h"
#include "sim/observation_noise.h"

namespace npdr::pipeline {
namespace {

struct PosteriorArguments {
  std::string posterior;
  std::string recording;  ///< --x: another observation
  Index count = 1000;
  std::uint64_t seed = 0;
  std::string theta;  ///< file of log-prob
};

/// Posteriors that a command line names: one, or those of a study's method.
struct ChosenPosteriors {
  PosteriorArguments posterior;  ///< its `posterior` may be a study
  StudyArguments study;          ///< which of the study's
};

// Largest difference of what simulations take from a recording: actions, and states they begin in.
double difference_of_inputs(const Target& a, const Target& b, Index segment_length) {
  double largest = 0.0;
  for (std::size_t h = 0; h < std::min(a.rollouts.size(), b.rollouts.size()); ++h) {
    const Rollout &mine = a.rollouts[h], &other = b.rollouts[h];
    if (mine.actions.size() > 0) {
      largest = std::max(largest, (mine.actions - other.actions).cwiseAbs().maxCoeff());
    }
    const Index every = segment_length > 0 ? segment_length : mine.num_steps();
    for (Index t = 0; t < mine.num_steps(); t += every) {
      largest = std::max(largest, (mine.states.row(t) - other.states.row(t)).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

// Simulations replayed the study's own rollouts: a recording of others came about in another way.
void warn_of_other_inputs(const std::string& recording, const Target& target,
                          const std::string& posterior, const ArtefactInfo& info,
                          Index segment_length) {
  const auto key = info.identity.inputs.find("target");
  if (key == info.identity.inputs.end()) return;
  const std::filesystem::path own = WorkFolder::beside(std::filesystem::canonical(posterior),
                                                       name_of(Stage::target), key->second);
  std::error_code unreadable;
  if (!std::filesystem::exists(own, unreadable)) return;
  const Target replayed = read_recording(own);
  const double difference = difference_of_inputs(target, replayed, segment_length);
  const double rounding = 1e-6 * sim::reference_amplitude(replayed).maxCoeff();
  if (difference <= rounding) return;
  print_warning(fmt::format(
      "{} has other actions, or begins in other states, than the rollouts that the "
      "simulations replayed (by up to {:.3g}); what it says of theta is then wrong: fit it "
      "with a study of its own",
      recording, difference));
}

struct Observation {
  VectorF x;
  std::vector<Channel> features;  ///< names; none of what is embedded
};

// x of another recording, embedded as the posterior's own observation was.
Observation embed_recording(const std::string& posterior, const std::string& recording) {
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  const ArtefactInfo info = read_artefact_info(posterior);
  const auto embedding = from_json<inference::EmbeddingConfig>(
      parse_json(file.attribute<std::string>("embedding"), posterior), posterior);
  const auto table = from_json<SimulatorTable>(info.identity.study.at("simulator"),
                                               posterior + ": study.simulator");
  const Channels channels = observed_channels(posterior);
  if (!traits_of(table.external.kind()).gives_motion) {
    const Target target = read_observation(recording, channels.states);
    print_findings(warnings_of_observation(recording));
    return {
        inference::observed_features(*inference::make_embedding(embedding, target, 1), target, 1),
        channels.states};
  }
  const sim::SimulatorConfig& simulator = table.built_in;
  const Target target = read_recording(recording, channels);
  require_like_observation(recording, target, posterior);
  warn_of_other_inputs(recording, target, posterior, info, simulator.segment_length);
  return {inference::observed_features(
              *inference::make_embedding(embedding, target, simulator.store_every), target,
              simulator.store_every),
          {}};
}

// A network of later rounds has learned around its own x_o.
void warn_of_later_round(const std::string& posterior) {
  const auto document = read_artefact_info(posterior).identity.key_document;
  const auto round = document.find("round");
  if (round == document.end() || !round->is_number() || *round <= 1) return;
  print_warning(
      fmt::format("{} is of round {}, whose simulations were made for its own observation; for "
                  "others take that of round 1",
                  posterior, round->get<Index>()));
}

// The feature that is another than in all simulations, or far from their mean, where one is.
std::string conspicuous_feature(const inference::UsualFeatures& usual,
                                const Observation& observation) {
  const auto& [x, names] = observation;
  const auto name_of = [&names = names](Index f) {
    return f < std::ssize(names) ? "'" + names[static_cast<std::size_t>(f)].label + "'"
                                 : fmt::format("feature {}", f + 1);
  };
  if (const auto f = inference::impossible_feature(usual, x)) {
    const float lowest = usual.lowest(*f), highest = usual.highest(*f);
    return fmt::format("{} is {:.6g}, in all simulations {:.6g}{}", name_of(*f), x(*f), lowest,
                       lowest < highest ? fmt::format(" to {:.6g}", highest) : "");
  }
  RowMatrixF z;
  Index farthest = 0;
  usual.transform.standardize(x.transpose(), z);
  const float deviations = z.row(0).cwiseAbs().maxCoeff(&farthest);
  constexpr float usual_deviations = 4.0f;
  if (deviations < usual_deviations) return "its features together, no single one";
  return fmt::format("the farthest feature is {}, {:.3g} deviations from the mean",
                     name_of(farthest), deviations);
}

// Nor has it learned anything of what looks like no simulation.
void warn_of_unlike_simulations(const PosteriorArguments& arguments,
                                const Observation& observation) {
  const auto usual = read_usual_features({arguments.posterior});
  constexpr double level = 1e-3;  // false alarms
  const Index num_reference = usual ? usual->distances.rows() : 1;
  if (!inference::can_be_outside(num_reference, level)) {
    fmt::print(stderr, "note: the simulations of {} were too few to tell whether {} is like them\n",
               arguments.posterior, arguments.recording);
    return;
  }
  const double p = inference::test_out_of_distribution(*usual, observation.x).p_value;
  if (p >= level) return;
  print_warning(
      fmt::format("{} is unlike all simulations that the posterior was learned from (p = "
                  "{:.2g}; {}); what it says there is a guess: check the units, or widen the prior",
                  arguments.recording, p, conspicuous_feature(*usual, observation)));
}

std::string verdict_on_chains(double r_hat) {
  if (std::isnan(r_hat)) return "; too few samples of each chain to say more";
  return r_hat > inference::kLargestRHat
             ? "; they don't agree, so rows aren't independent, and modes may be badly weighted"
             : "";
}

// Prints how far Markov chains agree, where there are any.
void print_sampler(const inference::Samples& samples) {
  if (!samples.report || samples.report->r_hat.size() == 0) return;
  const double r_hat = samples.report->r_hat.maxCoeff<Eigen::PropagateNaN>();
  fmt::print(stderr, "chains: largest R-hat {:.3f}, smallest effective sample size {:.0f}{}\n",
             r_hat, samples.report->ess.minCoeff<Eigen::PropagateNaN>(), verdict_on_chains(r_hat));
}

std::unique_ptr<inference::Posterior> read(const PosteriorArguments& arguments) {
  if (arguments.recording.empty()) return read_posterior({arguments.posterior});
  const auto posterior = read_network_posterior({arguments.posterior});
  const Observation observation = embed_recording(arguments.posterior, arguments.recording);
  auto other = posterior->given(observation.x);
  warn_of_later_round(arguments.posterior);
  warn_of_unlike_simulations(arguments, observation);
  return other;
}

// Anybody may have made the file, and some crash HDF5: a child goes first.
std::unique_ptr<inference::Posterior> load(const PosteriorArguments& arguments) {
  try_to_read(arguments.posterior, [&] { read(arguments); });
  return read(arguments);
}

// Weights that are finite may still overflow in the sums of a network.
void require_numbers(const PosteriorArguments& arguments, bool are_numbers) {
  if (are_numbers) return;
  throw Error(arguments.posterior +
              ": its network's answer isn't a number: its weights, or x, are too large; train it "
              "anew, with a smaller training.learning_rate where that may have made them so");
}

// Weighted particles, and weighted draws of a network, are drawn again and again; fewer than a
// hundredth of them change nothing.
void note_repeats(const RowMatrix& theta) {
  const Index repeats = inference::num_repeated_rows(theta);
  if (repeats < std::max<Index>(1, theta.rows() / 100)) return;
  fmt::print(
      stderr,
      "note: {} of {} rows repeat others: this posterior is drawn from weighted points; they are "
      "right for means and predictions, but no {} different draws\n",
      repeats, theta.rows(), theta.rows());
}

// As a study's check does of its own observation. Of an angle over all of its period both ends may
// hold samples.
void warn_of_pressed_bounds(const inference::Prior& prior, const RowMatrix& theta) {
  if (theta.rows() < inference::kFewestForBounds) return;
  std::vector<std::string> pressed;
  for (Index d = 0; d < theta.cols(); ++d) {
    const inference::Marginal& marginal = prior.marginals()[static_cast<std::size_t>(d)];
    const std::vector<PressedBound> bounds = pressed_bounds(marginal, theta.col(d));
    if (bounds.size() != 1) continue;
    pressed.push_back(fmt::format("{} at {:.4g}", marginal.name, bounds.front().value));
  }
  if (pressed.empty()) return;
  print_warning(
      fmt::format("the samples press against the end of the prior ({}), which may exclude the "
                  "truth: widen it in a study of this observation",
                  join(pressed)));
}

// Samples of posterior k = 0, 1, ... of those that are pooled, the first after the names of the
// parameters. Each has random numbers of its own.
void print_samples(const PosteriorArguments& arguments, Index k) {
  const auto posterior = load(arguments);
  const inference::Samples samples = posterior->draw(
      arguments.count, {arguments.seed, "sample", static_cast<std::uint64_t>(k), 0, 0});
  const RowMatrix& theta = samples.theta;
  require_numbers(arguments, theta.allFinite());
  print_sampler(samples);
  note_repeats(theta);
  if (!arguments.recording.empty()) warn_of_pressed_bounds(posterior->prior(), theta);
  std::vector<std::string> header;
  for (const auto& m : posterior->prior().marginals()) {
    header.push_back(analysis::quote_csv(fmt::format("{} [{}]", m.name, m.unit)));
  }
  if (k == 0) fmt::print("{}\n", printable_line(join(header, ",")));
  for (Index i = 0; i < theta.rows(); ++i) {
    fmt::print("{:.17g}\n", fmt::join(theta.row(i).begin(), theta.row(i).end(), ","));
  }
}

// The one method of the plan that infers, or that of --only.
const MethodConfig& only_method(const Plan& plan, const std::vector<std::string>& selected) {
  std::vector<std::string> names;
  for (const MethodConfig& method : plan.study.methods) {
    const bool is_selected = selected.empty() || std::ranges::count(selected, method.name) > 0;
    if (infers(method) && is_selected) names.push_back(method.name);
  }
  if (names.size() == 1) return plan.study.method(names.front());
  throw InputError(fmt::format("{}: {} methods infer ({}), must be one: choose it by --method",
                               plan.study.name, names.size(), join(names)));
}

// Posteriors of a study's method, in the order of seeds.
std::vector<std::string> posteriors_of(const Plan& plan, const StudyArguments& arguments) {
  const MethodConfig& method = only_method(plan, arguments.methods);
  const Index iterations = plan.study.num_iterations_of(method);
  std::vector<std::string> paths;
  for (const std::uint64_t seed : plan.study.seeds) {
    const auto& wanted = arguments.seeds;
    if (!wanted.empty() && std::ranges::count(wanted, seed) == 0) continue;
    const Use use{method.name, seed, method.algorithm.num_rounds, iterations > 1 ? iterations : 0};
    const Node& node = plan.node(Stage::infer, use);
    if (!is_complete(plan, node)) {
      throw InputError(
          fmt::format("{}: isn't there yet; run it first: {}", node.label(), plan.command));
    }
    open_artefact(node, kPosteriorSchema);  // of this key
    paths.push_back(node.path);
  }
  return paths;
}

// A file holds one posterior, as it was trained.
void require_nothing_chosen(const ChosenPosteriors& chosen) {
  const auto refuse = [&](const char* option, const auto& given) {
    if (given.empty()) return;
    throw InputError(
        fmt::format("{}: is one posterior; {} chooses among those of a study: leave "
                    "it out, or name the study's .toml in place of the file",
                    chosen.posterior.posterior, option));
  };
  refuse("--only, or --method,", chosen.study.methods);
  refuse("--seeds", chosen.study.seeds);
  refuse("--set", chosen.study.overrides);
}

// One for each, which count the same.
std::vector<PosteriorArguments> each_of(const ChosenPosteriors& chosen, const char* program) {
  if (!chosen.posterior.posterior.ends_with(".toml")) {
    require_nothing_chosen(chosen);
    return {chosen.posterior};
  }
  StudyArguments study = chosen.study;
  study.file = chosen.posterior.posterior;
  const Plan plan = study.plan_here(program);
  std::vector<PosteriorArguments> all;
  for (const std::string& path : posteriors_of(plan, study)) {
    all.push_back(chosen.posterior);
    all.back().posterior = path;
  }
  warn_of_failed_checks(plan, only_method(plan, study.methods).name);
  return all;
}

// The samples are shared out among the posteriors.
void print_samples_of(const ChosenPosteriors& chosen) {
  std::vector<PosteriorArguments> all = each_of(chosen, "npdr sample");
  const auto num = static_cast<Index>(all.size());
  for (Index i = 0; i < num; ++i) {
    PosteriorArguments& one = all[static_cast<std::size_t>(i)];
    one.count = chosen.posterior.count / num + (i < chosen.posterior.count % num ? 1 : 0);
    if (one.count > 0) print_samples(one, i);
  }
}

RowMatrix read_theta(const std::string& path, const inference::Prior& prior) {
  const SampleSet set = read_sample_set(path, "theta", std::numeric_limits<Index>::max());
  if (!set.columns.empty()) {
    std::vector<Channel> parameters;
    for (const auto& m : prior.marginals()) parameters.push_back({m.name, m.unit});
    return set.rows(Eigen::all, find_columns(set.where, set.columns, parameters));
  }
  if (set.rows.cols() == prior.dimension()) return set.rows;
  throw InputError(fmt::format("{}: {} without names, must be {}, one for each parameter",
                               set.where, counted(set.rows.cols(), "column"), prior.dimension()));
}

// The density of several is their mean.
void print_log_prob(const ChosenPosteriors& chosen) {
  RowMatrix theta, log_prob;  // (n, D), (n, posteriors)
  for (const PosteriorArguments& one : each_of(chosen, "npdr log-prob")) {
    const auto posterior = load(one);
    if (theta.size() == 0) theta = read_theta(one.theta, posterior->prior());
    log_prob.conservativeResize(theta.rows(), log_prob.cols() + 1);
    log_prob.rightCols(1) = posterior->log_prob(theta);
    require_numbers(one, !log_prob.rightCols(1).hasNaN());
  }
  fmt::print("log_prob\n");
  for (Index i = 0; i < log_prob.rows(); ++i) {
    fmt::print("{:.17g}\n", log_mean_exp(log_prob.row(i)));
  }
}

void add_options(CLI::App& command, ChosenPosteriors& chosen) {
  command
      .add_option("POSTERIOR", chosen.posterior.posterior,
                  "posterior artefact (infer.h5), or a study")
      ->required();
  command.add_option("--x", chosen.posterior.recording,
                     "another recording, or file of x_o, to condition on");
  chosen.study.add_selection_to(command);
  command.get_option("--method")->description("that of a study's methods, where several infer");
}

}  // namespace

Action sample_command(CLI::App& command) {
  auto chosen = std::make_shared<ChosenPosteriors>();
  add_options(command, *chosen);
  command.add_option("-n,--num-samples", chosen->posterior.count, "how many")
      ->capture_default_str()
      ->check(CLI::Range(Index{1}, Index{100'000'000}));
  add_seed_option(command, "--seed", chosen->posterior.seed,
                  "of the draws; see --seeds for a study's");
  command.footer(
      "Examples:\n  npdr sample runs/study/npe/seed-1/round-1/infer.h5 -n 500\n"
      "  npdr sample study.toml --method NPE --seeds 1\n"
      "  npdr sample study.toml --method NPE        (all seeds pooled)");
  return [chosen] {
    print_samples_of(*chosen);
    return ExitStatus::done;
  };
}

Action log_prob_command(CLI::App& command) {
  auto chosen = std::make_shared<ChosenPosteriors>();
  add_options(command, *chosen);
  command.add_option("THETA", chosen->posterior.theta, "CSV or HDF5 with a column per parameter")
      ->required();
  command.footer(
      "Examples:\n  npdr log-prob runs/study/npe/seed-1/round-1/infer.h5 theta.csv\n"
      "  npdr log-prob study.toml theta.csv --method NPE        (all seeds pooled)");
  return [chosen] {
    print_log_prob(*chosen);
    return ExitStatus::done;
  };
}

}  // namespace npdr::pipeline
