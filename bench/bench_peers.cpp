// What a number of epochs of training and posterior samples cost, of the single networks that other
// libraries have, too, with the same sizes, batches and chains: see against_sbi.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "bench/known_posteriors.h"
#include "core/error.h"
#include "inference/network_posterior.h"

namespace npdr::bench {
namespace {

using inference::Algorithm;
using inference::EstimatorKind;
using Clock = std::chrono::steady_clock;

struct Options {
  Index num_simulations = 2000;
  Index epochs = 20;
  Index batch_size = 50;
  Index num_samples = 10'000;
  std::filesystem::path data;  ///< where theta.csv, x.csv and x_o.csv are written
};

struct Method {
  std::string name;
  Algorithm algorithm;
  EstimatorKind estimator;
};

const std::vector<Method> kMethods = {{"NPE, MAF", Algorithm::npe_c, EstimatorKind::maf},
                                      {"NPE, NSF", Algorithm::npe_c, EstimatorKind::nsf},
                                      {"NPE, MDN", Algorithm::npe_c, EstimatorKind::mdn},
                                      {"NLE, MAF", Algorithm::nle, EstimatorKind::maf},
                                      {"NRE-B", Algorithm::nre_b, EstimatorKind::resnet}};

inference::PosteriorEstimationConfig config_of(const Method& method, const Options& options) {
  inference::PosteriorEstimationConfig config;
  config.algorithm.kind = method.algorithm;
  config.algorithm.num_rounds = 1;
  config.algorithm.num_simulations = options.num_simulations;
  config.estimator.kind = method.estimator;
  config.estimator.num_bins = 10;
  // Those of against_sbi.py.
  config.sampler = {.num_chains = 200, .num_warmup = 100};
  config.training.batch_size = options.batch_size;
  config.training.max_epochs = options.epochs;
  config.training.stop_after_epochs = options.epochs + 1;
  return config;
}

void write_csv(const std::filesystem::path& path, const RowMatrix& rows) {
  const Eigen::IOFormat csv(Eigen::FullPrecision, Eigen::DontAlignCols, ",", "\n");
  std::ofstream file(path);
  file << rows.format(csv) << '\n';
  if (!file.flush()) throw Error(path.string() + ": couldn't be written");
}

void write_data(const KnownPosterior& task, const Options& options) {
  const RowMatrix theta = inference::sample_prior(task.prior, options.num_simulations, 1);
  write_csv(options.data / "theta.csv", theta);
  write_csv(options.data / "x.csv",
            inference::simulate(task.simulator, theta, 1, 1).cast<double>());
  write_csv(options.data / "x_o.csv", observation(task, 1).transpose().cast<double>());
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void print_method(const KnownPosterior& task, const Method& method, const Options& options) {
  auto start = Clock::now();
  const auto posterior = inference::infer(config_of(method, options), task.prior, task.simulator,
                                          observation(task, 1), 1);
  const double training = seconds_since(start);
  start = Clock::now();
  posterior->sample(options.num_samples, {1, "posterior", 0, 0, 0});
  fmt::print("{};{:.4f};{:.4f}\n", method.name, training, seconds_since(start));
  std::fflush(stdout);
}

}  // namespace
}  // namespace npdr::bench

int main(int argc, char** argv) {
  using namespace npdr;
  bench::Options options;
  CLI::App app("Seconds of training and of posterior samples of single networks on slcp");
  app.add_option("--num-simulations", options.num_simulations)->check(CLI::PositiveNumber);
  app.add_option("--epochs", options.epochs)->check(CLI::PositiveNumber);
  app.add_option("--batch-size", options.batch_size)->check(CLI::PositiveNumber);
  app.add_option("--num-samples", options.num_samples)->check(CLI::PositiveNumber);
  app.add_option("--data", options.data, "folder for theta.csv, x.csv and x_o.csv")
      ->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  try {
    const bench::KnownPosterior task = bench::known_posterior("slcp");
    if (!options.data.empty()) bench::write_data(task, options);
    for (const bench::Method& method : bench::kMethods) bench::print_method(task, method, options);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
