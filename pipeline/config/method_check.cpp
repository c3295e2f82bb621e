#include "pipeline/config/method_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "inference/algorithms/pool_powers.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/method_settings.h"

namespace npdr::pipeline {
namespace {

// "; 'refine' reads it", where that is a help.
std::string readers_of(const std::string& setting) {
  constexpr std::size_t most = 3;
  std::vector<std::string> readers;
  for (const inference::AlgorithmTraits& algorithm : enum_table(inference::Algorithm{})) {
    if (reads_setting(algorithm.value, setting))
      readers.push_back(quoted(std::string(algorithm.name)));
  }
  if (readers.empty() || readers.size() > most) return "";
  return fmt::format("; {} read{} it", join(readers), readers.size() == 1 ? "s" : "");
}

class MethodChecker : Checker {
 public:
  MethodChecker(Study& study, const sim::SimulatorInfo* info, Reading& reading)
      : Checker(reading), study_(study), info_(info) {}

  void check(std::size_t i);

 private:
  void check_embedding(const std::string& path, const inference::EmbeddingConfig& embedding);
  void check_training(const std::string& path, const MethodConfig& method);
  void check_split(const std::string& path, const MethodConfig& method);
  void check_estimator(const std::string& path, MethodConfig& method);
  void check_networks(const std::string& path, const MethodConfig& method);
  void check_loss(const std::string& path, const MethodConfig& method);
  void check_rounds(const std::string& path, const MethodConfig& method);
  void check_abc(const std::string& path, const MethodConfig& method);
  void check_regression(const std::string& path);
  void check_refine(const std::string& path, const MethodConfig& method);
  void check_first_states(const std::string& key, const MethodConfig& method);
  void check_start(const std::string& path, const MethodConfig& method);
  void check_unused_settings(const std::string& path, const MethodConfig& method);
  void check_iterations(const std::string& path, const MethodConfig& method);

  Study& study_;
  const sim::SimulatorInfo* info_;
};

void MethodChecker::check(std::size_t i) {
  MethodConfig& method = study_.methods[i];
  const std::string path = fmt::format("method[{}]", i);
  const Index available = study_.target.num_rollouts;
  if (available > 0 && method.num_rollouts > available) {
    fail(path + ".num_rollouts", std::to_string(method.num_rollouts),
         fmt::format("<= target.num_rollouts = {}", available));
  }
  check_unused_settings(path, method);
  check_iterations(path, method);
  check_embedding(path + ".embedding", method.embedding);
  check_rounds(path, method);
  switch (inference::traits_of(method.algorithm.kind).family) {
    case inference::AlgorithmFamily::network:
      check_training(path, method);
      check_estimator(path, method);
      check_loss(path, method);
      break;
    case inference::AlgorithmFamily::abc:
      check_abc(path, method);
      break;
    case inference::AlgorithmFamily::regression:
      check_regression(path);
      break;
    case inference::AlgorithmFamily::likelihood:
      check_refine(path, method);
      break;
    case inference::AlgorithmFamily::fixed:
      break;
  }
  const std::vector<std::string> metrics = names_of<Metric>();
  for (const auto& [metric, figure] : method.published) {
    require_known(fmt::format("{}.published.{}", path, metric), "method.published", "metric",
                  metric, metrics);
  }
}

void MethodChecker::check_embedding(const std::string& path,
                                    const inference::EmbeddingConfig& embedding) {
  const Index store_every = study_.simulator.store_every;
  const bool readable =
      reading_.good(path + ".downsample") && reading_.good("simulator.store_every");
  if (readable && embedding.downsample % store_every != 0) {
    fail(path + ".downsample", std::to_string(embedding.downsample),
         fmt::format("a multiple of simulator.store_every = {}", store_every));
  }
  const std::string components = path + ".principal_components";
  if (embedding.kind == inference::EmbeddingKind::convolution &&
      embedding.principal_components > 0 && reading_.good(components)) {
    fail(components, std::to_string(embedding.principal_components),
         "0 with kind 'convolution', which sees steps; 'all_steps' has principal components");
  }
  if (!info_ || !study_.source().gives_motion) return;  // features may not be known yet
  std::vector<std::string> labels;
  for (const Channel& channel : info_->state_channels) labels.push_back(channel.label);
  for (const std::string& channel : embedding.channels) {
    require_known(path + ".channels", display(path) + ".channels", "channel", channel, labels);
  }
}

void MethodChecker::check_training(const std::string& path, const MethodConfig& method) {
  const std::string batch = path + ".training.batch_size";
  constexpr Index fewest = 2 * inference::kFewestTrainingRows;
  if (const Index count = method.algorithm.num_simulations;
      count < fewest && reading_.good(path + ".num_simulations")) {
    fail(path + ".num_simulations", std::to_string(count),
         fmt::format(">= {}, {} each for training and for validation", fewest, fewest / 2));
    return;
  }
  const double rows =
      static_cast<double>(num_learned_from(method)) * (1.0 - method.training.validation_fraction);
  const bool readable = reading_.good(batch) && reading_.good(path + ".num_simulations") &&
                        reading_.good(path + ".training.validation_fraction");
  // Half a row of slack: 1 - 0.2 isn't exact.
  if (readable && static_cast<double>(method.training.batch_size) > rows + 0.5) {
    fail(batch, std::to_string(method.training.batch_size),
         fmt::format("<= {:.0f}, the simulations of a round that training sees "
                     "(without validation_fraction and, of 'npe_nle', a twentieth that judges)",
                     rows));
  }
  check_split(path, method);
}

// The trainer's split gives each part at least its share of the rows, rounded down.
void MethodChecker::check_split(const std::string& path, const MethodConfig& method) {
  constexpr Index fewest = inference::kFewestTrainingRows;
  const std::string fraction = path + ".training.validation_fraction";
  if (!reading_.good(fraction) || !reading_.good(path + ".num_simulations")) return;
  const Index rows = num_learned_from(method);
  const auto share = [&](double part) {
    return static_cast<Index>(std::floor(part * static_cast<double>(rows) + 1e-9));
  };
  const double validation = method.training.validation_fraction;
  if (share(1.0 - validation) >= fewest && share(validation) >= fewest) return;
  fail(fraction, fmt::format("{}", method.training.validation_fraction),
       fmt::format("such that {} or more of the {} simulations of a round are left for training "
                   "and for validation each",
                   fewest, rows));
}

void MethodChecker::check_estimator(const std::string& path, MethodConfig& method) {
  const std::string kind_path = path + ".density_estimator.kind";
  if (!reading_.good(path + ".algorithm") || !reading_.good(kind_path)) return;
  const inference::AlgorithmTraits& algorithm = inference::traits_of(method.algorithm.kind);
  if (!reading_.has(kind_path)) method.density_estimator.kind = algorithm.estimators.front();
  check_networks(path, method);
  const inference::EstimatorKind kind = method.density_estimator.kind;
  if (std::ranges::count(algorithm.estimators, kind) == 0) {
    fail(kind_path, quoted(name_of(kind)),
         fmt::format("one of {} with algorithm '{}'", inference::estimator_list(algorithm),
                     algorithm.name));
  }
  if (trains_layers(method.embedding.kind) && algorithm.role != inference::NetworkRole::posterior) {
    fail(path + ".embedding.kind", quoted(name_of(method.embedding.kind)),
         fmt::format("another with algorithm '{}', which can't train one: such as 'all_steps' with "
                     "principal_components",
                     algorithm.name));
  }
}

void MethodChecker::check_networks(const std::string& path, const MethodConfig& method) {
  const std::string key = path + ".density_estimator.num_networks";
  if (inference::allows_ensembles(inference::traits_of(method.algorithm.kind))) return;
  if (method.density_estimator.num_networks == 1 || !reading_.good(key)) return;
  fail(key, std::to_string(method.density_estimator.num_networks),
       fmt::format("1 with algorithm '{}': the posteriors of several can't be averaged",
                   name_of(method.algorithm.kind)));
}

void MethodChecker::check_loss(const std::string& path, const MethodConfig& method) {
  const inference::AlgorithmConfig& algorithm = method.algorithm;
  if (!reading_.good(path + ".algorithm") || !reading_.good(path + ".loss")) return;
  const inference::EstimatorKind kind = method.density_estimator.kind;
  if (!reading_.good(path + ".density_estimator.kind")) return;
  if (algorithm.kind == inference::Algorithm::npe_c &&
      algorithm.loss == inference::Loss::analytic && kind != inference::EstimatorKind::mdn) {
    fail(path + ".loss", "'analytic'",
         "'auto' or 'atomic' with density_estimator.kind = '" + name_of(kind) +
             "': only 'mdn' has one");
    return;
  }
  const bool is_atomic =
      reads_setting(algorithm.kind, "num_atoms") && !inference::is_analytic(algorithm, kind);
  const bool readable =
      reading_.good(path + ".num_atoms") && reading_.good(path + ".training.batch_size");
  if (is_atomic && readable && algorithm.num_atoms > method.training.batch_size) {
    fail(path + ".num_atoms", std::to_string(algorithm.num_atoms),
         fmt::format("<= training.batch_size = {}", method.training.batch_size));
  }
}

// Where an optimizer is wrong, nobody knows what means nothing to it.
void MethodChecker::check_unused_settings(const std::string& path, const MethodConfig& method) {
  if (!reading_.good(path + ".algorithm")) return;
  PolicyConfig policy = study_.policy;
  if (!reading_.good("policy.optimizer"))
    policy.search.kind = inference::PolicyOptimizerKind::power;
  std::vector<UnusedField> unused = unused_fields(method, policy, path);
  for (auto& [setting, use] : unused) {
    if (!use.settable) continue;  // not the algorithm's
    if (!is_in_file(path + ".algorithm")) use.unused += ", which a method has that names none";
    use.unused += readers_of(setting.substr(path.size() + 1));
  }
  must_be_left_out(unused);
}

void MethodChecker::check_iterations(const std::string& path, const MethodConfig& method) {
  const std::string iterations = path + ".num_iterations";
  if (!reading_.good("policy.optimizer")) return;
  if (!study_.policy.is_used()) {
    if (reading_.good(path + ".algorithm") && !infers(method)) {
      fail(path + ".algorithm", quoted(name_of(method.algorithm.kind)),
           "another without a table [policy]: it infers nothing, there is only its policy to look "
           "at");
    }
    return;
  }
  if (method.num_iterations > 1 && !study_.target.truth && reading_.good(iterations)) {
    fail(iterations, std::to_string(method.num_iterations),
         "1 without target.truth: only in a simulated target domain can a policy collect more "
         "rollouts");
  }
}

void MethodChecker::check_rounds(const std::string& path, const MethodConfig& method) {
  const std::string rounds = path + ".num_rounds";
  if (!inference::traits_of(method.algorithm.kind).has_one_round) return;
  if (method.algorithm.num_rounds == 1 || !reading_.good(rounds)) return;
  fail(rounds, std::to_string(method.algorithm.num_rounds),
       fmt::format("1 with algorithm '{}', whose simulations all come from the prior: raise "
                   "num_simulations",
                   name_of(method.algorithm.kind)));
}

void MethodChecker::check_abc(const std::string& path, const MethodConfig& method) {
  const std::string kind = path + ".embedding.kind", rounds = path + ".num_rounds";
  if (reading_.good(kind) && trains_layers(method.embedding.kind)) {
    fail(kind, quoted(name_of(method.embedding.kind)),
         fmt::format("another with algorithm '{}', which trains no layer: such as 'all_steps'",
                     name_of(method.algorithm.kind)));
  }
  if (!reading_.good(rounds)) return;
  if (method.algorithm.kind == inference::Algorithm::abc_mcmc && method.algorithm.num_rounds < 2) {
    fail(rounds, std::to_string(method.algorithm.num_rounds),
         ">= 2 with algorithm 'abc_mcmc': chains take one step in each round");
  }
}

void MethodChecker::check_refine(const std::string& path, const MethodConfig& method) {
  if (!study_.source().simulates) {
    reading_.fail(path + ".algorithm", "algorithm 'refine' needs a simulator, not a dataset");
  } else if (study_.observation_noise.is_silent() && reading_.good("observation_noise")) {
    reading_.fail(path + ".algorithm",
                  "algorithm 'refine' needs [observation_noise], whose density is its likelihood: "
                  "give scale, scale_prior or std");
  }
  const inference::ImportanceConfig& sampling = method.refine.sampling;
  const std::string most = path + ".refine.max_simulations";
  const bool are_good = reading_.good(most) && reading_.good(path + ".refine.level_size");
  if (are_good && sampling.max_simulations < inference::kFewestLevels * sampling.level_size) {
    fail(most, std::to_string(sampling.max_simulations),
         fmt::format(">= {} times refine.level_size = {}: draws of the start, of what they teach, "
                     "and those that are reported",
                     inference::kFewestLevels, sampling.level_size));
  }
  if (are_good && sampling.max_simulations / inference::kMostLevels > sampling.level_size) {
    fail(most, std::to_string(sampling.max_simulations),
         fmt::format("at most {} times refine.level_size = {}", inference::kMostLevels,
                     sampling.level_size));
  }
  const Index rollouts = method.num_rollouts > 0 ? method.num_rollouts : study_.target.num_rollouts;
  if (sampling.cross_validate && (rollouts == 1 || !study_.source().gives_motion)) {
    fail(path + ".refine.cross_validate", "true",
         "false with a single rollout: none can be left out");
  }
  check_first_states(path + ".refine.infer_first_states", method);
  check_start(path, method);
}

void MethodChecker::check_first_states(const std::string& key, const MethodConfig& method) {
  if (!method.refine.infer_first_states || !reading_.good(key)) return;
  const ObservationNoise& noise = study_.observation_noise;
  if (!study_.source().gives_motion) {
    fail(key, "true", "false where a simulator gives features: they have no first states");
  } else if (study_.target.truth) {
    fail(key, "true", "false with target.truth: first states of a simulated target are exact");
  } else if (noise.degrees_of_freedom || noise.degrees_of_freedom_prior) {
    fail(key, "true",
         "false with observation_noise.degrees_of_freedom: first states are integrated out of "
         "Gaussian noise, white or correlated");
  } else if (const Index length = study_.simulator.segment_length,
             every = study_.simulator.store_every;
             length > 0 && (length < 2 * every || length % every != 0)) {
    fail(key, "true",
         fmt::format("false, or simulator.segment_length = {} two or more times "
                     "simulator.store_every = {}: segments need stored states beside their first, "
                     "at equal distances",
                     length, every));
  }
}

void MethodChecker::check_start(const std::string& path, const MethodConfig& method) {
  const std::string key = path + ".refine.start";
  if (method.refine.start.empty() || !reading_.good(key)) return;
  std::vector<std::string> names;
  for (const MethodConfig& other : study_.methods) {
    const auto family = inference::traits_of(other.algorithm.kind).family;
    if (infers(other) && family != inference::AlgorithmFamily::likelihood) {
      names.push_back(other.name);
    }
  }
  if (!require_known(key, display(path) + ".refine.start", "method to refine", method.refine.start,
                     names)) {
    return;
  }
  if (method.num_iterations > 1 || study_.method(method.refine.start).num_iterations > 1) {
    fail(key, quoted(method.refine.start),
         "left out where a method has several num_iterations: each iteration has a recording of "
         "its own");
  }
}

void MethodChecker::check_regression(const std::string& path) {
  if (!info_ || !reading_.good(path + ".algorithm")) return;
  const auto form = study_.source().is_built_in
                        ? sim::make_simulator({.name = info_->name})->regression_form()
                        : nullptr;
  if (!form) {
    const std::string needed = join(sim::simulators_with_regression(), "' or '");
    reading_.fail(path + ".algorithm",
                  fmt::format("algorithm 'linear_regression' needs simulator.name = '{}', found "
                              "'{}': only its equations are a linear regression",
                              needed, info_->name));
    return;
  }
  std::vector<std::string> identified;
  for (const Index p : form->identified()) {
    identified.push_back(info_->parameters[static_cast<std::size_t>(p)].name);
  }
  const auto is_identified = [&](const inference::Marginal& m) {
    return std::ranges::count(identified, m.name) > 0;
  };
  if (std::ranges::any_of(study_.prior, is_identified)) return;
  reading_.fail(path + ".algorithm",
                fmt::format("algorithm 'linear_regression' identifies {}; the prior must have one "
                            "of them at least",
                            join(identified)));
}

}  // namespace

void check_method(Study& study, std::size_t i, const sim::SimulatorInfo* info, Reading& reading) {
  MethodChecker(study, info, reading).check(i);
}

}  // namespace npdr::pipeline
