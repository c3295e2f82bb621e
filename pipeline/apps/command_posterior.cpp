// Commands that use a trained posterior: sample and log-prob.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>

#include "analysis/escape.h"
#include "core/error.h"
#include "core/log_sum_exp.h"
#include "core/printable.h"
#include "core/text.h"
#include "inference/conditional_posterior.h"
#include "inference/diagnostics/bound_pressure.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "inference/diagnostics/two_samples.h"
#include "inference/embeddings/embedding.h"
#include "inference/particle_posterior.h"
#include "inference/samplers/chain_diagnostics.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
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
  std::string posterior;           ///< a file, or a study, whose method's posteriors count the same
  StudyArguments study;            ///< which of the study's
  std::string recording;           ///< --x: another observation
  std::vector<std::string> given;  ///< --given: NAME=NUMBER
  Index count = 1000;
  std::uint64_t seed = 0;
  std::string theta;  ///< file of log-prob
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
  const h5::File file = open_artefact({posterior}, kPosteriorSchema);
  const ArtefactInfo info = read_artefact_info(posterior);
  const auto config = from_json<inference::EmbeddingConfig>(
      parse_json(file.attribute<std::string>("embedding"), posterior), posterior);
  const auto table = from_json<SimulatorTable>(info.identity.study.at("simulator"),
                                               posterior + ": study.simulator");
  const Channels channels = observed_channels(posterior);
  const auto embedded = [&](const Target& target, Index store_every) {
    const auto embedding = inference::make_embedding(config, target, store_every);
    return inference::observed_features(*embedding, target, store_every);
  };
  if (!traits_of(table.external.kind()).gives_motion) {
    const Target target = read_observation(recording, channels.states);
    print_findings(warnings_of_observation(recording));
    return {embedded(target, 1), channels.states};
  }
  const sim::SimulatorConfig& simulator = table.built_in;
  const Target target = read_recording(recording, channels);
  require_like_observation(recording, target, posterior);
  warn_of_other_inputs(recording, target, posterior, info, simulator.segment_length);
  return {embedded(target, simulator.store_every), {}};
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
void warn_of_unlike_simulations(const std::string& posterior, const std::string& recording,
                                const Observation& observation) {
  const auto usual = read_usual_features({posterior});
  constexpr double level = 1e-3;  // false alarms
  if (!inference::can_be_outside(usual ? usual->distances.rows() : 1, level)) {
    fmt::print(stderr, "note: the simulations of {} were too few to tell whether {} is like them\n",
               posterior, recording);
    return;
  }
  const double p = inference::test_out_of_distribution(*usual, observation.x).p_value;
  if (p >= level) return;
  print_warning(
      fmt::format("{} is unlike all simulations that the posterior was learned from (p = "
                  "{:.2g}; {}); what it says there is a guess: check the units, or widen the prior",
                  recording, p, conspicuous_feature(*usual, observation)));
}

// Prints how far Markov chains agree, where there are any.
void print_sampler(const inference::Samples& samples) {
  if (!samples.report || samples.report->r_hat.size() == 0) return;
  const double r_hat = samples.report->r_hat.maxCoeff<Eigen::PropagateNaN>();
  std::string verdict;
  if (std::isnan(r_hat)) verdict = "; too few samples of each chain to say more";
  if (r_hat > inference::kLargestRHat) {
    verdict = "; they don't agree: rows aren't independent, modes may be badly weighted";
  }
  fmt::print(stderr, "chains: largest R-hat {:.3f}, smallest effective sample size {:.0f}{}\n",
             r_hat, samples.report->ess.minCoeff<Eigen::PropagateNaN>(), verdict);
}

// Anybody may have made the file, and some crash HDF5: a child goes first.
std::unique_ptr<inference::Posterior> load(const std::string& path, const std::string& recording) {
  const auto read = [&]() -> std::unique_ptr<inference::Posterior> {
    if (recording.empty()) return read_posterior({path});
    const auto posterior = read_network_posterior({path});
    const Observation observation = embed_recording(path, recording);
    auto other = posterior->given(observation.x);
    warn_of_later_round(path);
    warn_of_unlike_simulations(path, recording, observation);
    return other;
  };
  try_to_read(path, read);
  return read();
}

using Given = std::vector<std::pair<std::string, double>>;

Given parse_given(const std::vector<std::string>& texts) {
  Given given;
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const char* const end = text.data() + text.size();
    const char* const begin = std::min(text.data() + equals + 1, end);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (equals == 0 || begin == end || stop != end || error != std::errc() ||
        !std::isfinite(value)) {
      throw InputError("--given " + quoted(text) + ": must be NAME=NUMBER, such as mass=0.2");
    }
    given.emplace_back(text.substr(0, equals), value);
  }
  return given;
}

// Where a posterior has no samples, its density is what a network makes of nothing.
void warn_of_improbable(const std::string& path, const inference::Posterior& whole,
                        const Given& given) {
  constexpr Index num_samples = 1000;
  const RowMatrix theta = whole.sample(num_samples, {0, "given", 0, 0, 0});
  const std::vector<inference::Marginal>& parameters = whole.prior().marginals();
  for (const auto& [name, value] : given) {
    const auto place = std::ranges::find(parameters, name, &inference::Marginal::name);
    const auto column = theta.col(place - parameters.begin());
    if (value >= column.minCoeff() && value <= column.maxCoeff()) continue;
    print_warning(fmt::format(
        "{}: {} = {:.6g} lies outside of the range of {} samples of the posterior ({:.4g} to "
        "{:.4g}), where its density is a guess",
        path, name, value, num_samples, column.minCoeff(), column.maxCoeff()));
  }
}

std::unique_ptr<inference::Posterior> load_given(const std::string& path,
                                                 const PosteriorArguments& arguments) {
  const Given given = parse_given(arguments.given);
  auto whole = load(path, arguments.recording);
  if (given.empty()) return whole;
  const auto* const particles = dynamic_cast<const inference::ParticlePosterior*>(whole.get());
  if (particles != nullptr && particles->parts().space == inference::ParticleSpace::theta) {
    throw InputError(path +
                     ": a linear regression's samples may lie outside of the prior, and "
                     "can't be conditioned: leave out --given, or take another method's");
  }
  const inference::Posterior& before = *whole;
  auto rest = std::make_unique<inference::ConditionalPosterior>(std::move(whole), given);
  warn_of_improbable(path, before, given);
  return rest;
}

// Weights that are finite may still overflow in the sums of a network.
void require_numbers(const std::string& posterior, bool are_numbers) {
  if (are_numbers) return;
  throw Error(posterior +
              ": its network's answer isn't a number: its weights, or x, are too large; train it "
              "anew, maybe with a smaller training.learning_rate");
}

// Weighted particles, and weighted draws of a network, are drawn again and again; fewer than a
// hundredth of them change nothing.
void note_repeats(const RowMatrix& theta) {
  const Index repeats = inference::num_repeated_rows(theta);
  if (repeats < std::max<Index>(1, theta.rows() / 100)) return;
  fmt::print(stderr,
             "note: {} of {} rows repeat others: this posterior is drawn from weighted points, "
             "which is right for means and predictions\n",
             repeats, theta.rows());
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

// `count` samples of posterior k = 0, 1, ... of those that are pooled, the first after the names of
// the parameters. Each has random numbers of its own.
void print_samples(const PosteriorArguments& arguments, const std::string& path, Index count,
                   Index k) {
  const auto posterior = load_given(path, arguments);
  const inference::Samples samples =
      posterior->draw(count, {arguments.seed, "sample", static_cast<std::uint64_t>(k), 0, 0});
  const RowMatrix& theta = samples.theta;
  require_numbers(path, theta.allFinite());
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

// The files of all posteriors.
std::vector<std::string> files_of(const PosteriorArguments& arguments, const char* program) {
  StudyArguments study = arguments.study;
  if (!arguments.posterior.ends_with(".toml")) {
    if (study.methods.empty() && study.seeds.empty() && study.overrides.empty()) {
      return {arguments.posterior};
    }
    throw InputError(arguments.posterior +
                     ": is one posterior; --method, --seeds and --set choose among those of a "
                     "study: leave them out, or name the study's .toml in place of the file");
  }
  study.file = arguments.posterior;
  const Plan plan = study.plan_here(program);
  std::vector<std::string> files;
  const auto posteriors = last_nodes_of_method(plan, Stage::infer, study.methods);
  for (const auto& [node, use] : posteriors) {
    open_artefact(*node, kPosteriorSchema);  // of this key
    files.push_back(node->path);
  }
  warn_of_failed_checks(plan, posteriors.front().use.method);
  return files;
}

// The samples are shared out among the posteriors.
void print_samples_of(const PosteriorArguments& arguments) {
  const std::vector<std::string> files = files_of(arguments, "npdr sample");
  const auto num = static_cast<Index>(files.size());
  for (Index i = 0; i < num; ++i) {
    const Index count = arguments.count / num + (i < arguments.count % num ? 1 : 0);
    if (count > 0) print_samples(arguments, files[static_cast<std::size_t>(i)], count, i);
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
void print_log_prob(const PosteriorArguments& arguments) {
  RowMatrix theta, log_prob;  // (n, D), (n, posteriors)
  for (const std::string& file : files_of(arguments, "npdr log-prob")) {
    const auto posterior = load_given(file, arguments);
    if (theta.size() == 0) theta = read_theta(arguments.theta, posterior->prior());
    log_prob.conservativeResize(theta.rows(), log_prob.cols() + 1);
    log_prob.rightCols(1) = posterior->log_prob(theta);
    require_numbers(file, !log_prob.rightCols(1).hasNaN());
  }
  fmt::print("log_prob\n");
  for (Index i = 0; i < log_prob.rows(); ++i) {
    fmt::print("{:.17g}\n", log_mean_exp(log_prob.row(i)));
  }
}

std::shared_ptr<PosteriorArguments> add_options(CLI::App& command) {
  auto arguments = std::make_shared<PosteriorArguments>();
  command
      .add_option("POSTERIOR", arguments->posterior, "posterior artefact (infer.h5), or a study")
      ->required();
  command.add_option("--x", arguments->recording,
                     "another recording, or file of x_o, to condition on");
  command
      .add_option(
          "--given", arguments->given,
          "NAME=NUMBER: a parameter whose value is known; may be repeated; the output is of "
          "the others")
      ->allow_extra_args(false);
  arguments->study.add_selection_to(command);
  command.get_option("--method")->description("that of a study's methods, where several infer");
  return arguments;
}

}  // namespace

Action sample_command(CLI::App& command) {
  auto arguments = add_options(command);
  command.add_option("-n,--num-samples", arguments->count, "how many")
      ->capture_default_str()
      ->check(CLI::Range(Index{1}, Index{100'000'000}));
  add_seed_option(command, "--seed", arguments->seed, "of the draws; see --seeds for a study's");
  command.footer(
      "Examples:\n  npdr sample runs/study/npe/seed-1/round-1/infer.h5 -n 500\n"
      "  npdr sample study.toml --method NPE --seeds 1\n"
      "  npdr sample study.toml --method NPE        (all seeds pooled)\n"
      "  npdr sample study.toml --method NPE --given mass=0.2 --given length=1");
  return done_after([arguments] { print_samples_of(*arguments); });
}

Action log_prob_command(CLI::App& command) {
  auto arguments = add_options(command);
  command
      .add_option("THETA", arguments->theta,
                  "CSV or HDF5 with a column per parameter that isn't given")
      ->required();
  command.footer(
      "Examples:\n  npdr log-prob runs/study/npe/seed-1/round-1/infer.h5 theta.csv\n"
      "  npdr log-prob study.toml theta.csv --method NPE        (all seeds pooled)");
  return done_after([arguments] { print_log_prob(*arguments); });
}

}  // namespace npdr::pipeline
