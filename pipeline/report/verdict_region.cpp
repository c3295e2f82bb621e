// Words for a posterior so narrow that hardly any simulations lie where it is.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "pipeline/report/table_parts.h"
#include "pipeline/report/verdict_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kPriorDraws = 10'000;
constexpr double kShareOfPosterior = 0.99;

// Draws of the prior in the coordinates in which it is N(0, I).
RowMatrix normal_draws(Index dimension) {
  RowMatrix draws(kPriorDraws, dimension);
  Stream stream({1, "region", 0, 0, 0});
  for (double& value : draws.reshaped<Eigen::RowMajor>()) value = stream.normal();
  return draws;
}

// The share of the prior, of which these are draws, within the ellipsoid that holds 99 % of samples
// in the same coordinates, and what so many draws may miss; 1 where the samples have none.
double share_of_prior(const RowMatrix& draws, const RowMatrix& samples) {
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
  const Index within = (distances(draws.rowwise() - mean).array() <= farthest).count();
  constexpr double unseen = 3.0;  // where that many are expected none is drawn in 5 % of cases
  return (static_cast<double>(within) + unseen) / static_cast<double>(kPriorDraws);
}

}  // namespace

std::string words_of_region(const ReportData& data, const std::string& method) {
  constexpr double most_simulations = 300.0;
  constexpr Index rounds = 4;
  const Study& study = data.plan.study;
  const inference::AlgorithmConfig& algorithm = study.method(method).algorithm;
  const bool can_go_on = study.source().simulates && algorithm.num_rounds == 1 &&
                         algorithm.kind == inference::Algorithm::npe_nle;
  if (!can_go_on) return "";
  const inference::Prior prior(study.prior);
  const RowMatrix draws = normal_draws(prior.dimension());
  const double share = each(data.runs_of(method), [&](const EvaluatedRun* run) {
                         return share_of_prior(draws, prior.to_normal(run->evaluation.theta));
                       }).mean();
  const double expected = share * static_cast<double>(algorithm.num_simulations);
  const double largest_share = std::min(0.05, std::exp2(-static_cast<double>(prior.dimension())));
  if (share > largest_share || expected > most_simulations) return "";
  return fmt::format(
      "only about {:.0f} of {} simulations lie where it is: more of them there make it more exact, "
      "by num_rounds = {} and num_simulations = {}, for this observation alone",
      std::ceil(expected), algorithm.num_simulations, rounds,
      (algorithm.num_simulations + rounds - 1) / rounds);
}

}  // namespace npdr::pipeline
