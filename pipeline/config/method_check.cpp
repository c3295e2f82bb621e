#include <cmath>

#include "pipeline/config/checker.h"
#include "pipeline/config/constraint.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

using inference::EmbeddingKind;
using inference::EstimatorKind;

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
  MethodChecker(const Study& study, std::size_t i, const sim::SimulatorInfo* info, Reading& reading)
      : Checker(study, info, reading),
        method_(study.methods[i]),
        algorithm_(inference::traits_of(method_.algorithm.kind)),
        path_(method_path(i)) {}

  void check() {
    const Index available = study_.target.num_rollouts;
    require(at("num_rollouts"), method_.num_rollouts,
            available == 0 || method_.num_rollouts <= available,
            fmt::format("<= target.num_rollouts = {}", available));
    check_unused_settings();
    check_iterations();
    check_embedding();
    require(at("num_rounds"), num_rounds(), !algorithm_.has_one_round || num_rounds() == 1,
            fmt::format("1 with algorithm '{}', whose simulations all come from the prior: raise "
                        "num_simulations",
                        algorithm_.name));
    using enum inference::AlgorithmFamily;
    if (algorithm_.family == network) {
      check_training();
      check_estimator();
      check_loss();
    }
    if (algorithm_.family == abc) check_abc();
    if (algorithm_.family == regression) check_regression();
    if (algorithm_.family == likelihood) check_refine();
    if (algorithm_.family == fit && !study_.source().gives_motion) {
      fail(at("algorithm"),
           "algorithm 'least_squares' needs a simulator of rollouts, not of features");
    }
    for (const auto& [metric, figure] : method_.published) {
      require_known(at("published." + metric), "method.published", "metric", metric,
                    names_of<Metric>());
    }
  }

 private:
  std::string at(const std::string& key) const { return path_ + "." + key; }
  Index num_rounds() const { return method_.algorithm.num_rounds; }

  void check_unused_settings() {
    if (!reading_.good(at("algorithm"))) return;
    PolicyConfig policy = study_.policy;
    // Where an optimizer is wrong, nobody knows what means nothing to it.
    if (!reading_.good("policy.optimizer")) {
      policy.search.kind = inference::PolicyOptimizerKind::power;
    }
    std::vector<UnusedField> unused = unused_fields(fields_of(method_, policy), path_);
    for (auto& [setting, use] : unused) {
      if (!use.settable) continue;  // not the algorithm's
      if (!is_in_file(at("algorithm"))) use.unused += ", which a method has that names none";
      use.unused += readers_of(setting.substr(path_.size() + 1));
    }
    must_be_left_out(unused);
  }

  void check_iterations() {
    if (!reading_.good("policy.optimizer")) return;
    if (!study_.policy.is_used()) {
      require(at("algorithm"), method_.algorithm.kind, infers(method_),
              "another without a table [policy]: it infers nothing, there is only its policy to "
              "look at");
      return;
    }
    require(at("num_iterations"), method_.num_iterations,
            method_.num_iterations == 1 || study_.target.truth.has_value(),
            "1 without target.truth: only in a simulated target domain can a policy collect more "
            "rollouts");
  }

  void check_embedding() {
    const inference::EmbeddingConfig& embedding = method_.embedding;
    const Index store_every = study_.simulator.store_every;
    require(at("embedding.downsample"), embedding.downsample,
            embedding.downsample % store_every == 0,
            fmt::format("a multiple of simulator.store_every = {}", store_every),
            {"simulator.store_every"});
    require(at("embedding.principal_components"), embedding.principal_components,
            embedding.kind != EmbeddingKind::convolution || embedding.principal_components == 0,
            "0 with kind 'convolution', which sees steps; 'all_steps' has principal components");
    if (!study_.source().gives_motion) return;  // features may not be known yet
    if (!embedding.shape.empty()) {
      must_be_left_out({at("embedding.shape")},
                       "it is for features; rollouts have a shape already");
    }
    if (!info_) return;
    const std::string path = at("embedding.channels");
    for (const std::string& channel : embedding.channels) {
      require_known(path, display(path), "channel", channel, labels_of(info_->state_channels));
    }
  }

  void check_training() {
    constexpr Index fewest = 2 * inference::kFewestTrainingRows;
    const std::string simulations = at("num_simulations");
    const Index count = method_.algorithm.num_simulations;
    if (!require(simulations, count, count >= fewest,
                 fmt::format(">= {}, {} each for training and for validation", fewest, fewest / 2)))
      return;
    const std::string fraction = at("training.validation_fraction");
    const inference::TrainingConfig& training = method_.training;
    const double rows =
        static_cast<double>(num_learned_from(method_)) * (1.0 - training.validation_fraction);
    // Half a row of slack: 1 - 0.2 isn't exact.
    require(at("training.batch_size"), training.batch_size,
            static_cast<double>(training.batch_size) <= rows + 0.5,
            fmt::format("<= {:.0f}, the simulations of a round that training sees "
                        "(without validation_fraction and, of 'npe_nle', a twentieth that judges)",
                        rows),
            {simulations, fraction});
    require(fraction, training.validation_fraction, can_be_split(),
            fmt::format("such that {} or more of the {} simulations of a round are left for "
                        "training and for validation each",
                        inference::kFewestTrainingRows, num_learned_from(method_)),
            {simulations});
  }

  // The trainer's split gives each part at least its share of the rows, rounded down.
  bool can_be_split() const {
    const auto share = [&](double part) {
      return std::floor(part * static_cast<double>(num_learned_from(method_)) + 1e-9);
    };
    const double validation = method_.training.validation_fraction;
    constexpr auto fewest = static_cast<double>(inference::kFewestTrainingRows);
    return share(1.0 - validation) >= fewest && share(validation) >= fewest;
  }

  void check_estimator() {
    const std::string path = at("density_estimator.kind");
    const EstimatorKind kind = method_.density_estimator.kind;
    if (!reading_.good(at("algorithm")) || !reading_.good(path)) return;
    require(at("density_estimator.num_networks"), method_.density_estimator.num_networks,
            inference::allows_ensembles(algorithm_) || method_.density_estimator.num_networks == 1,
            fmt::format("1 with algorithm '{}': the posteriors of several can't be averaged",
                        algorithm_.name));
    require(path, kind, std::ranges::count(estimators_of(algorithm_), kind) > 0,
            fmt::format("one of {} with algorithm '{}'", inference::estimator_list(algorithm_),
                        algorithm_.name));
    const inference::EmbeddingConfig& embedding = method_.embedding;
    require(at("embedding.kind"), embedding.kind,
            algorithm_.role == inference::NetworkRole::posterior || !embedding.trains_layers(),
            fmt::format("another with algorithm '{}', which can't train one: such as 'all_steps' "
                        "with principal_components",
                        algorithm_.name));
  }

  void check_loss() {
    using inference::Algorithm, inference::Loss;
    const inference::AlgorithmConfig& algorithm = method_.algorithm;
    const EstimatorKind kind = method_.density_estimator.kind;
    for (const char* key : {"algorithm", "loss", "density_estimator.kind"}) {
      if (!reading_.good(at(key))) return;
    }
    const bool has_loss = algorithm.kind != Algorithm::npe_c || algorithm.loss != Loss::analytic ||
                          traits_of(kind).gives(inference::Estimate::mixture);
    if (!require(at("loss"), algorithm.loss, has_loss,
                 fmt::format("'auto' or 'atomic' with density_estimator.kind = '{}': only 'mdn' "
                             "has one",
                             name_of(kind)))) {
      return;
    }
    const bool is_atomic =
        reads_setting(algorithm.kind, "num_atoms") && !inference::is_analytic(algorithm, kind);
    require(at("num_atoms"), algorithm.num_atoms,
            !is_atomic || algorithm.num_atoms <= method_.training.batch_size,
            fmt::format("<= training.batch_size = {}", method_.training.batch_size),
            {at("training.batch_size")});
  }

  void check_abc() {
    require(at("embedding.kind"), method_.embedding.kind, !method_.embedding.trains_layers(),
            fmt::format("another with algorithm '{}', which trains no layer: such as 'all_steps'",
                        algorithm_.name));
    require(at("num_rounds"), num_rounds(),
            algorithm_.value != inference::Algorithm::abc_mcmc || num_rounds() >= 2,
            ">= 2 with algorithm 'abc_mcmc': chains take one step in each round");
  }

  void check_refine() {
    if (!study_.source().simulates) {
      fail(at("algorithm"), "algorithm 'refine' needs a simulator, not a dataset");
    } else if (study_.observation_noise.is_silent() && reading_.good("observation_noise")) {
      fail(at("algorithm"),
           "algorithm 'refine' needs [observation_noise], whose density is its likelihood: "
           "give scale, scale_prior or std");
    }
    const auto& [start, infer_first_states, sampling] = method_.refine;
    const Index most = sampling.max_simulations, level = sampling.level_size;
    require(at("refine.max_simulations"), most, most >= inference::kFewestLevels * level,
            fmt::format(">= {} times refine.level_size = {}: draws of the start, of what they "
                        "teach, and those that are reported",
                        inference::kFewestLevels, level),
            {at("refine.level_size")});
    require(at("refine.max_simulations"), most, most / inference::kMostLevels <= level,
            fmt::format("at most {} times refine.level_size = {}", inference::kMostLevels, level),
            {at("refine.level_size")});
    const Index rollouts =
        method_.num_rollouts > 0 ? method_.num_rollouts : study_.target.num_rollouts;
    require(at("refine.cross_validate"), sampling.cross_validate,
            !sampling.cross_validate || (rollouts != 1 && study_.source().gives_motion),
            "false with a single rollout: none can be left out");
    if (infer_first_states) check_first_states(at("refine.infer_first_states"));
    if (!start.empty()) check_start(at("refine.start"));
  }

  void check_first_states(const std::string& key) {
    const ObservationNoise& noise = study_.observation_noise;
    const Index length = study_.simulator.segment_length, every = study_.simulator.store_every;
    require(key, true, study_.source().gives_motion,
            "false where a simulator gives features: they have no first states") &&
        require(key, true, !study_.target.truth,
                "false with target.truth: first states of a simulated target are exact") &&
        require(key, true, !noise.is_heavy_tailed(),
                "false with observation_noise.degrees_of_freedom: first states are integrated out "
                "of Gaussian noise, white or correlated") &&
        require(key, true, length == 0 || (length >= 2 * every && length % every == 0),
                fmt::format("false, or simulator.segment_length = {} two or more times "
                            "simulator.store_every = {}: segments need stored states beside their "
                            "first, at equal distances",
                            length, every));
  }

  void check_start(const std::string& key) {
    const std::string& start = method_.refine.start;
    if (!reading_.good(key)) return;
    std::vector<std::string> names;
    for (const MethodConfig& other : study_.methods) {
      const bool refines = family_of(other) == inference::AlgorithmFamily::likelihood;
      if (infers(other) && !refines) names.push_back(other.name);
    }
    if (!require_known(key, display(key), "method to refine", start, names)) return;
    require(key, start, method_.num_iterations == 1 && study_.method(start).num_iterations == 1,
            "left out where a method has several num_iterations: each iteration has a recording of "
            "its own");
  }

  void check_regression() {
    const std::string path = at("algorithm");
    if (!info_ || !reading_.good(path)) return;
    const auto form = study_.source().is_built_in
                          ? sim::make_simulator({.name = info_->name})->regression_form()
                          : nullptr;
    if (!form) {
      const std::string needed = join(sim::simulators_with_regression(), "' or '");
      return fail(path, fmt::format("algorithm 'linear_regression' needs simulator.name = '{}', "
                                    "found '{}': only its equations are a linear regression",
                                    needed, info_->name));
    }
    std::vector<std::string> identified;
    for (const Index p : form->identified()) {
      identified.push_back(info_->parameters[static_cast<std::size_t>(p)].name);
    }
    const auto is_identified = [&](const inference::Marginal& m) {
      return std::ranges::count(identified, m.name) > 0;
    };
    if (std::ranges::any_of(study_.prior, is_identified)) return;
    fail(path, fmt::format("algorithm 'linear_regression' identifies {}; the prior must have "
                           "one of them at least",
                           join(identified)));
  }

  const MethodConfig& method_;
  const inference::AlgorithmTraits& algorithm_;
  std::string path_;
};

}  // namespace

void check_method(const Study& study, std::size_t i, const sim::SimulatorInfo* info,
                  Reading& reading) {
  MethodChecker(study, i, info, reading).check();
}

}  // namespace npdr::pipeline
