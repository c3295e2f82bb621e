// Every method against posteriors that are known: C2ST of posterior samples (0.5: can't be told
// from exact ones, 1: they don't overlap) for several budgets of simulations, mean over several
// observations, and what it cost.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <optional>

#include "analysis/table_writers.h"
#include "bench/known_posteriors.h"
#include "core/error.h"
#include "core/text.h"
#include "inference/diagnostics/c2st.h"
#include "inference/network_posterior.h"
#include "pipeline/store/h5.h"

namespace npdr::bench {
namespace {

using inference::Algorithm;
using inference::EstimatorKind;
using inference::PosteriorEstimationConfig;
using inference::Tails;
using Clock = std::chrono::steady_clock;

struct Method {
  std::string name;
  PosteriorEstimationConfig config;
  inference::AbcConfig abc = {};
};

Method method(const std::string& name, Algorithm algorithm, EstimatorKind estimator,
              Index num_rounds) {
  PosteriorEstimationConfig config;
  config.algorithm.kind = algorithm;
  config.algorithm.num_rounds = num_rounds;
  config.estimator.kind = estimator;
  config.tails = Tails::compressed;
  return {name, config};
}

// The mean of five networks: the first is what a study has that says nothing.
Method ensemble_method(const std::string& name, Algorithm algorithm, EstimatorKind estimator,
                       Index num_rounds = 1) {
  Method m = method(name, algorithm, estimator, num_rounds);
  m.config.estimator.num_networks = 5;
  return m;
}

// Particles are smoothed by the density's kernel: otherwise samples repeat them, which any
// classifier sees.
Method abc_method(const std::string& name, Algorithm algorithm, Index num_rounds, double quantile) {
  Method m = method(name, algorithm, {}, num_rounds);
  m.abc.quantile = quantile;
  m.abc.smooth = true;
  return m;
}

std::vector<Method> all_methods() {
  return {ensemble_method("NPE and NLE, 5 splines", Algorithm::npe_nle, EstimatorKind::nsf),
          ensemble_method("NPE and NLE, 5 splines, 4 rounds", Algorithm::npe_nle,
                          EstimatorKind::nsf, 4),
          ensemble_method("NPE, 5 splines", Algorithm::npe_c, EstimatorKind::nsf),
          ensemble_method("NPE, 5 MAFs", Algorithm::npe_c, EstimatorKind::maf),
          ensemble_method("NLE, 5 splines", Algorithm::nle, EstimatorKind::nsf),
          ensemble_method("NLE, 5 MAFs", Algorithm::nle, EstimatorKind::maf),
          method("NPE, MAF", Algorithm::npe_c, EstimatorKind::maf, 1),
          method("NPE, MoG", Algorithm::npe_c, EstimatorKind::mdn, 1),
          method("NPE, splines", Algorithm::npe_c, EstimatorKind::nsf, 1),
          method("NLE, MAF, 1 round", Algorithm::nle, EstimatorKind::maf, 1),
          method("NLE, splines, 1 round", Algorithm::nle, EstimatorKind::nsf, 1),
          method("NRE-B, 1 round", Algorithm::nre_b, EstimatorKind::resnet, 1),
          method("NPE-A, MoG, 2 rounds", Algorithm::npe_a, EstimatorKind::mdn, 2),
          method("NPE-B, MAF", Algorithm::npe_b, EstimatorKind::maf, 4),
          method("NPE-C, MAF", Algorithm::npe_c, EstimatorKind::maf, 4),
          method("NPE-C, MoG", Algorithm::npe_c, EstimatorKind::mdn, 4),
          method("NPE-C, splines", Algorithm::npe_c, EstimatorKind::nsf, 4),
          method("NLE, MAF", Algorithm::nle, EstimatorKind::maf, 4),
          method("NLE, splines", Algorithm::nle, EstimatorKind::nsf, 4),
          method("NRE-A", Algorithm::nre_a, EstimatorKind::resnet, 4),
          method("NRE-B", Algorithm::nre_b, EstimatorKind::resnet, 4),
          abc_method("ABC, rejection", Algorithm::abc_rejection, 1, 0.02),
          abc_method("ABC, SMC", Algorithm::abc_smc, 4, 0.5),
          abc_method("ABC, MCMC", Algorithm::abc_mcmc, 10, 0.1)};
}

// What was observed, and exact samples of the posterior given that.
struct Observation {
  VectorF x_o;
  RowMatrix exact;  ///< (n, D)
};

std::vector<Observation> own_observations(const KnownPosterior& task, Index count,
                                          Index num_samples, std::uint64_t seed) {
  std::vector<Observation> observations;
  for (Index i = 1; i <= count; ++i) {
    VectorF x_o = observation(task, i);
    RowMatrix exact = task.exact_samples(x_o, num_samples, seed);
    observations.push_back({std::move(x_o), std::move(exact)});
  }
  return observations;
}

// Those of a file with groups observation_1, observation_2, ... of x_o (F) and
// reference_posterior (n, D).
std::vector<Observation> published_observations(const std::filesystem::path& path, Index count,
                                                Index num_samples) {
  const auto file = pipeline::h5::File::open(path);
  std::vector<Observation> observations;
  for (Index i = 1; i <= count; ++i) {
    const auto group = file.group(fmt::format("observation_{}", i));
    const RowMatrixF exact = group.read_matrix<float>("reference_posterior");
    const auto x_o = group.dataset("x_o").read<double>();
    observations.push_back({Vector::Map(x_o.data(), std::ssize(x_o)).cast<float>(),
                            exact.topRows(std::min(num_samples, exact.rows())).cast<double>()});
  }
  return observations;
}

struct Score {
  std::optional<double> c2st;   ///< mean over observations; none: the budget is too small
  double train_seconds = 0.0;   ///< of all trainings; simulations cost next to nothing here
  double sample_seconds = 0.0;  ///< of one observation
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

using PosteriorPointer = std::shared_ptr<const inference::Posterior>;

PosteriorPointer infer(const KnownPosterior& task, const Method& method, const VectorF& x_o,
                       std::uint64_t seed) {
  const inference::Algorithm algorithm = method.config.algorithm.kind;
  if (inference::traits_of(algorithm).family == inference::AlgorithmFamily::abc) {
    return inference::infer_abc(method.config.algorithm, method.abc, task.prior, task.simulator,
                                x_o, seed);
  }
  return inference::infer(method.config, task.prior, task.simulator, x_o, seed);
}

// Posteriors given another observation: that of a network which saw the prior's simulations alone
// holds for all of them.
PosteriorPointer given(const PosteriorPointer& posterior, const Method& method,
                       const VectorF& x_o) {
  const auto* network = dynamic_cast<const inference::NetworkPosterior*>(posterior.get());
  if (!network || method.config.algorithm.num_rounds > 1) return nullptr;
  return network->given(x_o);
}

Score score(const KnownPosterior& task, const std::vector<Observation>& observations, Method method,
            Index num_simulations, std::uint64_t seed) {
  inference::AlgorithmConfig& algorithm = method.config.algorithm;
  algorithm.num_simulations = num_simulations / algorithm.num_rounds;
  Score score;
  PosteriorPointer posterior;
  double c2st = 0.0;
  for (const auto& [x_o, exact] : observations) {
    auto start = Clock::now();
    posterior = given(posterior, method, x_o);
    if (!posterior) posterior = infer(task, method, x_o, seed);
    score.train_seconds += seconds_since(start);
    start = Clock::now();
    const RowMatrix samples = posterior->sample(exact.rows(), {seed, "posterior", 0, 0, 0});
    const double count = static_cast<double>(observations.size());
    score.sample_seconds += seconds_since(start) / count;
    c2st += inference::c2st(exact, samples, {seed, "c2st", 0, 0, 0}).accuracy / count;
  }
  score.c2st = c2st;
  return score;
}

struct Options {
  std::vector<std::string> tasks = known_posterior_names();
  std::vector<std::string> methods;
  std::vector<Index> num_simulations = {1'000, 10'000};
  Index num_observations = 3;
  Index num_samples = 10'000;
  std::filesystem::path published;  ///< folder of TASK.h5; empty: observations of our own
  std::uint64_t seed = 1;
};

std::vector<Observation> observations_of(const KnownPosterior& task, const Options& options) {
  if (options.published.empty()) {
    return own_observations(task, options.num_observations, options.num_samples, options.seed);
  }
  return published_observations(options.published / (task.name + ".h5"), options.num_observations,
                                options.num_samples);
}

Score score_or_failure(const KnownPosterior& task, const std::vector<Observation>& observations,
                       const Method& m, Index num_simulations, const Options& options) {
  Score result;
  try {
    result = score(task, observations, m, num_simulations, options.seed);
    fmt::print(stderr, "{}, {}, {} simulations: C2ST {:.3f}, {:.1f} s, {:.1f} s\n", task.name,
               m.name, num_simulations, *result.c2st, result.train_seconds, result.sample_seconds);
  } catch (const Error& error) {
    fmt::print(stderr, "{}, {}, {} simulations: {}\n", task.name, m.name, num_simulations,
               error.what());
  }
  return result;
}

analysis::Table empty_table(const KnownPosterior& task, const Options& options) {
  analysis::Table table;
  table.name = task.name;
  table.caption = fmt::format(
      "{}, {} parameters: C2ST of {} posterior samples, mean of {} observations, seed {}.",
      task.name, task.prior.dimension(), options.num_samples, options.num_observations,
      options.seed);
  table.row_header = "Method";
  for (const Index n : options.num_simulations) {
    table.columns.push_back(fmt::format("{} simulations", n));
  }
  table.columns.push_back(fmt::format("training, {} [s]", options.num_simulations.back()));
  table.columns.push_back(fmt::format("{} samples [s]", options.num_samples));
  return table;
}

bool is_wanted(const std::vector<std::string>& wanted, const std::string& name) {
  return wanted.empty() || std::ranges::find(wanted, name) != wanted.end();
}

void print_task(const KnownPosterior& task, const Options& options) {
  analysis::Table table = empty_table(task, options);
  const std::vector<Observation> observations = observations_of(task, options);
  for (const Method& m : all_methods()) {
    if (!is_wanted(options.methods, m.name)) continue;
    analysis::Row row{m.name, {}};
    Score last;
    for (const Index n : options.num_simulations) {
      last = score_or_failure(task, observations, m, n, options);
      row.cells.emplace_back(last.c2st ? fmt::format("{:.3f}", *last.c2st) : "none");
    }
    row.cells.emplace_back(fmt::format("{:.1f}", last.train_seconds));
    row.cells.emplace_back(fmt::format("{:.2f}", last.sample_seconds));
    table.rows.push_back(std::move(row));
  }
  std::cout << analysis::to_markdown(table) << '\n';
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const Method& m : all_methods()) names.push_back(m.name);
  return names;
}

}  // namespace
}  // namespace npdr::bench

int main(int argc, char** argv) {
  using namespace npdr;
  bench::Options options;
  CLI::App app("C2ST of every method on tasks whose posterior is known");
  app.add_option("--task", options.tasks, "tasks")
      ->check(CLI::IsMember(bench::known_posterior_names()));
  app.add_option("--method", options.methods, "methods; all when left out")
      ->check(CLI::IsMember(bench::method_names()));
  app.add_option("--num-simulations", options.num_simulations, "budgets, over all rounds")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  app.add_option("--num-observations", options.num_observations, "observations a task")
      ->check(CLI::PositiveNumber);
  app.add_option("--published", options.published,
                 "folder of TASK.h5 with observation_1/x_o and reference_posterior, ...: these in "
                 "place of our own observations")
      ->check(CLI::ExistingDirectory);
  app.add_option("--num-samples", options.num_samples, "posterior samples")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "of everything random");
  CLI11_PARSE(app, argc, argv);
  try {
    for (const std::string& name : options.tasks) {
      bench::print_task(bench::known_posterior(name), options);
    }
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
