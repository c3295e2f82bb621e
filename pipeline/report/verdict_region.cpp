// Words for a posterior so narrow that hardly any simulations lie where it is.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pipeline/report/table_parts.h"
#include "pipeline/report/verdict_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kPriorDraws = 10'000;
constexpr double kShareOfPosterior = 0.99;

// The share of the prior within the ellipsoid that holds 99 % of a run's samples, in coordinates of
// which the prior is standard normal; 1 where the samples have none.
double share_of_prior(const inference::Prior& prior, const RowMatrix& theta) {
  const RowMatrix samples = prior.to_normal(theta);
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const RowMatrix centered = samples.rowwise() - mean;
  const Eigen::LLT<Eigen::MatrixXd> root(centered.transpose() * centered /
                                         static_cast<double>(centered.rows()));
  if (root.info() != Eigen::Success) return 1.0;
  const auto distances = [&](const RowMatrix& from_mean) -> Vector {
    const Eigen::MatrixXd columns = from_mean.transpose();
    return root.matrixL().solve(columns).colwise().squaredNorm();
  };
  Vector own = distances(centered);
  std::sort(own.begin(), own.end());
  const double farthest =
      own(static_cast<Index>(kShareOfPosterior * static_cast<double>(own.size() - 1)));
  const RowMatrix draws = prior.to_normal(inference::sample_prior(prior, kPriorDraws, 1));
  const auto within = (distances(draws.rowwise() - mean).array() <= farthest).count();
  return static_cast<double>(within) / static_cast<double>(kPriorDraws);
}

}  // namespace

std::string words_of_region(const ReportData& data, const std::string& method) {
  constexpr double largest_share = 0.05, most_simulations = 300.0;
  constexpr Index rounds = 4;
  const Study& study = data.plan.study;
  const inference::AlgorithmConfig& algorithm = study.method(method).algorithm;
  const bool can_go_on = study.source().simulates && algorithm.num_rounds == 1 &&
                         algorithm.kind == inference::Algorithm::npe_nle;
  if (!can_go_on) return "";
  const inference::Prior prior(study.prior);
  const double share = each(data.runs_of(method), [&](const EvaluatedRun* run) {
                         return share_of_prior(prior, run->evaluation.theta);
                       }).mean();
  const double expected = share * static_cast<double>(algorithm.num_simulations);
  if (share > largest_share || expected > most_simulations) return "";
  return fmt::format(
      "only about {:.0f} of {} simulations lie where it is, in {:.2g} of the prior: more of them "
      "there make it more exact, by num_rounds = {} and num_simulations = {}, for this observation "
      "alone",
      std::max(expected, 1.0), algorithm.num_simulations, std::max(share, 1.0 / kPriorDraws),
      rounds, (algorithm.num_simulations + rounds - 1) / rounds);
}

}  // namespace npdr::pipeline
