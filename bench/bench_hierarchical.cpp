// Parameters that differ between rollouts around a common mean, beside the same for all: which
// predicts held-out rollouts better?
//
//   bench_hierarchical experiments/furuta_refined.toml --set target.recording=furuta_swingup_5s.h5
//     --set "method.refine={ max_simulations = 200_000 }"
//
// Over u, where the prior is N(0, I), rollout h has parameters of its own:
//   u_h ~ N(m, diag(tau^2)),   m_d ~ N(0, 1 - tau_d^2),   tau_d ~ U(0, 1),
// so that a priori each rollout's are N(0, I) as before. What a rollout says of its own, p(y_h |
// u), is the posterior given it alone over the prior, both taken as Gaussian. Gibbs sampling of
// u_h, tau and m (Gelman et al. 2013, "Bayesian Data Analysis", 3rd ed., 11.6) gives draws of the
// parameters of one more rollout. "Mixture": those of single rollouts' posteriors in equal parts.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <filesystem>
#include <iostream>
#include <numeric>

#include "analysis/table_writers.h"
#include "core/error.h"
#include "inference/prior.h"
#include "inference/weighted_population.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/predictions/scores.h"
#include "pipeline/run/run_stage.h"

namespace npdr::pipeline {
namespace {

constexpr Index kSamples = 1000;
constexpr Index kWarmUp = 500;
constexpr Index kThinning = 10;
constexpr Index kTauGrid = 200;

struct Options {
  std::filesystem::path study;
  std::vector<std::string> overrides;
  std::filesystem::path work = "bench-hierarchical";
};

// exp(-u' precision u / 2 + shift' u), what a rollout says of its parameters.
struct GaussianLikelihood {
  Eigen::MatrixXd precision;
  Vector shift;
};

GaussianLikelihood likelihood_of(const RowMatrix& u) {
  const Vector equal = Vector::Ones(u.rows());
  const Eigen::MatrixXd inverse = inference::weighted_covariance(u, equal).inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      inverse - Eigen::MatrixXd::Identity(u.cols(), u.cols()));
  const Eigen::MatrixXd precision = eigen.eigenvectors() *
                                    eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                                    eigen.eigenvectors().transpose();
  return {precision, inverse * inference::weighted_mean(u, equal)};
}

Vector normals(Index n, Stream& stream) {
  Vector z(n);
  for (double& value : z) value = stream.normal();
  return z;
}

// The Gibbs sampler's state.
class Hierarchy {
 public:
  explicit Hierarchy(std::vector<GaussianLikelihood> rollouts)
      : rollouts_(std::move(rollouts)),
        u_(std::ssize(rollouts_), rollouts_.front().shift.size()),
        mean_(Vector::Zero(u_.cols())),
        tau_(Vector::Constant(u_.cols(), 0.5)) {}

  void step(Stream& stream) {
    for (Index h = 0; h < u_.rows(); ++h) u_.row(h) = draw_rollout(h, stream).transpose();
    for (Index d = 0; d < u_.cols(); ++d) {
      tau_(d) = draw_tau(u_.col(d), stream);
      const double t2 = tau_(d) * tau_(d);
      const double precision = 1.0 / (1.0 - t2) + static_cast<double>(u_.rows()) / t2;
      mean_(d) = u_.col(d).sum() / t2 / precision + stream.normal() / std::sqrt(precision);
    }
  }

  const Vector& tau() const { return tau_; }
  Vector one_more(Stream& stream) const {
    return mean_ + tau_.cwiseProduct(normals(tau_.size(), stream));
  }

 private:
  Vector draw_rollout(Index h, Stream& stream) const {
    const GaussianLikelihood& rollout = rollouts_[static_cast<std::size_t>(h)];
    const Vector prior_precision = tau_.cwiseAbs2().cwiseInverse();
    const Eigen::LLT<Eigen::MatrixXd> factor(
        Eigen::MatrixXd(rollout.precision + Eigen::MatrixXd(prior_precision.asDiagonal())));
    const Vector shift = rollout.shift + prior_precision.cwiseProduct(mean_);
    return factor.solve(shift) + factor.matrixU().solve(normals(shift.size(), stream));
  }

  // Given the rollouts' u (H), m integrated out: their covariance is tau^2 I + (1 - tau^2) 1 1'.
  static double draw_tau(const Vector& u, Stream& stream) {
    const auto count = static_cast<double>(u.size());
    const double within = (u.array() - u.mean()).square().sum();
    const double between = count * u.mean() * u.mean();
    Vector logs(kTauGrid);
    for (Index i = 0; i < kTauGrid; ++i) {
      const double t2 = std::pow((static_cast<double>(i) + 0.5) / kTauGrid, 2);
      const double along = t2 + count * (1.0 - t2);
      logs(i) =
          -0.5 * ((count - 1.0) * std::log(t2) + within / t2 + std::log(along) + between / along);
    }
    Vector sums = (logs.array() - logs.maxCoeff()).exp();
    std::partial_sum(sums.begin(), sums.end(), sums.begin());
    const double at = stream.uniform() * sums(kTauGrid - 1);
    const auto i = std::ranges::lower_bound(sums, at) - sums.begin();
    return (static_cast<double>(i) + stream.uniform()) / kTauGrid;
  }

  std::vector<GaussianLikelihood> rollouts_;
  RowMatrix u_;
  Vector mean_;
  Vector tau_;
};

Plan plan_of(const Options& options, const std::vector<std::string>& more) {
  std::vector<std::string> overrides = options.overrides;
  overrides.insert(overrides.end(), more.begin(), more.end());
  return make_plan(read_study(options.study, overrides), WorkFolder(options.work));
}

// Draws of the posterior of the study's first method and seed, (n, D).
RowMatrix infer(const Plan& plan, Index n) {
  for (const Node& node : plan.nodes) {
    if (node.stage <= Stage::infer) run_stage(plan, node);
  }
  const MethodConfig& method = plan.study.methods.front();
  const Use use{.method = method.name,
                .seed = plan.study.seeds.front(),
                .round = method.algorithm.num_rounds};
  return read_posterior(plan.node(Stage::infer, use))->sample(n, {1, "posterior", 1, 0, 0});
}

// Of rollout h alone, counted from 0; those held out stay so.
RowMatrix infer_from(const Options& options, const Plan& all, Index h, Index n) {
  std::string rollouts = std::to_string(h + 1);
  const Index seen = all.target.num_rollouts() - all.study.target.held_out;
  for (Index i = seen; i < all.target.num_rollouts(); ++i) rollouts += fmt::format(", {}", i + 1);
  return infer(plan_of(options, {"target.num_rollouts=1", "target.rollouts=[" + rollouts + "]"}),
               n);
}

analysis::Row row_of(const Plan& plan, const std::string& label, const RowMatrix& theta) {
  const Use use{.method = plan.study.methods.front().name,
                .seed = plan.study.seeds.front(),
                .round = plan.study.methods.front().algorithm.num_rounds};
  const Judge judge(plan, plan.node(Stage::evaluate, use));
  const RowMatrix complete = plan.source->parameters().complete(theta);
  const PredictedRollouts predicted = judge.simulate(complete, {});
  const NoiseOfSamples noise = draw_noise(judge.seen().observation(), predicted.seen, {},
                                          {1, "bench_hierarchical", 1, 0, 0});
  const PredictionScores scores =
      *score(judge, predicted, noise, {1, "bench_hierarchical", 2, 0, 0}).held_out;
  const Index level = std::ranges::find(kBandLevels, 0.9) - kBandLevels.begin();
  return {
      label,
      {fmt::format("{:.3f}", scores.crps.mean()), fmt::format("{:.3f}", scores.noisy_crps.mean()),
       fmt::format("{:.2f}", scores.coverage.row(level).mean()),
       fmt::format("{:.2f}", scores.noisy_coverage.row(level).mean())}};
}

void run_bench(const Options& options) {
  const Plan plan = plan_of(options, {});
  if (!plan.study.target.recording || plan.study.target.held_out == 0) {
    throw InputError("bench_hierarchical needs a recording, of which rollouts are held out");
  }
  const inference::Prior prior(plan.study.prior);
  const Index count = plan.target.num_rollouts() - plan.study.target.held_out;
  analysis::Table table;
  table.name = "hierarchical";
  table.caption = "Scores of held-out rollouts.";
  table.row_header = "Posterior";
  for (const char* title : {"CRPS", "CRPS with noise", "90 % bands", "with noise"}) {
    table.columns.emplace_back(title);
  }
  table.rows.push_back(row_of(plan, "the same for all rollouts", infer(plan, kSamples)));

  std::vector<GaussianLikelihood> likelihoods;
  RowMatrix mixture(0, prior.dimension());
  for (Index h = 0; h < count; ++h) {
    const RowMatrix theta = infer_from(options, plan, h, kSamples);
    likelihoods.push_back(likelihood_of(prior.to_normal(theta)));
    mixture.conservativeResize(mixture.rows() + kSamples / count, Eigen::NoChange);
    mixture.bottomRows(kSamples / count) = theta.topRows(kSamples / count);
    table.rows.push_back(row_of(plan, fmt::format("of rollout {}", h + 1), theta));
  }
  table.rows.push_back(row_of(plan, "mixture", mixture));

  Hierarchy hierarchy(likelihoods);
  Stream stream({1, "bench_hierarchical", 0, 0, 0});
  RowMatrix u(kSamples, prior.dimension());
  Vector tau = Vector::Zero(prior.dimension());
  for (Index i = -kWarmUp; i < kSamples; ++i) {
    for (Index j = 0; j < kThinning; ++j) hierarchy.step(stream);
    if (i < 0) continue;
    u.row(i) = hierarchy.one_more(stream).transpose();
    tau += hierarchy.tau() / static_cast<double>(kSamples);
  }
  table.rows.push_back(row_of(plan, "hierarchical", prior.to_theta(u)));
  std::cout << analysis::to_markdown(table) << '\n';
  for (Index d = 0; d < tau.size(); ++d) {
    fmt::print("{}: tau {:.2f} of the prior's deviation\n",
               prior.marginals()[static_cast<std::size_t>(d)].name, tau(d));
  }
}

}  // namespace
}  // namespace npdr::pipeline

int main(int argc, char** argv) {
  using namespace npdr;
  pipeline::Options options;
  CLI::App app("Parameters of each rollout around a common mean, beside the same for all");
  app.add_option("study", options.study, "a study file with a recording, some of it held out")
      ->required();
  app.add_option("--set", options.overrides, "KEY=VALUE of the study, as of npdr run");
  app.add_option("--work", options.work, "folder for what is made");
  CLI11_PARSE(app, argc, argv);
  try {
    pipeline::run_bench(options);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
