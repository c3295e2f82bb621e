#include "pipeline/report/dataset_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "core/normal.h"
#include "inference/diagnostics/uniformity.h"
#include "inference/prior.h"
#include "pipeline/sources/dataset_rows.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostRows = 10'000, kMostCompared = 100'000;
constexpr double kFalseAlarmRate = 1e-4;
constexpr double kGraveDistance = 0.05, kGraveShare = 0.05, kGraveCorrelation = 0.2;

// F(theta), (n, D), of rows that are trained on and lie in the prior: uniform for draws of it.
struct UniformTheta {
  RowMatrix f;
  Index num_different = 0;  ///< rows of the same theta aren't independent
};

UniformTheta uniform_theta(const Plan& plan, std::uint64_t seed, Index count) {
  const inference::Prior prior(plan.study.prior);
  const RowMatrix all = *plan.source->theta(seed, count);
  std::vector<Index> inside;
  std::set<std::vector<double>> different;
  for (Index i = 0; i < all.rows(); ++i) {
    if (!prior.contains(all.row(i).transpose())) continue;
    inside.push_back(i);
    different.emplace(all.row(i).begin(), all.row(i).end());
  }
  const RowMatrix u = prior.to_normal(all(inside, Eigen::all));
  return {u.unaryExpr([](double v) { return normal_cdf(v); }), std::ssize(different)};
}

const std::string& name_of(const Plan& plan, Index d) {
  return plan.study.prior[static_cast<std::size_t>(d)].name;
}

// How far F is off because it has few values, such as those of whole numbers: half of a step.
double half_step(const Eigen::Ref<const Vector>& values) {
  const std::set<double> different(values.begin(), values.end());
  return different.size() > 1 ? 0.5 / static_cast<double>(different.size()) : 0.0;
}

void find_other_marginals(const Plan& plan, const UniformTheta& theta, DatasetFaults& found) {
  for (Index d = 0; d < theta.f.cols(); ++d) {
    const double statistic = inference::test_kolmogorov_smirnov(theta.f.col(d)).statistic;
    const double excess = std::max(0.0, statistic - half_step(theta.f.col(d)));
    const double p_value = inference::kolmogorov_smirnov_p_value(excess, theta.num_different);
    if (inference::corrected(p_value, theta.f.cols()) >= kFalseAlarmRate) continue;
    found.are_grave |= excess > kGraveDistance;
    found.faults.push_back(fmt::format(
        "{} of the dataset isn't distributed as the prior says (Kolmogorov-Smirnov {:.2f}, p = "
        "{:.1g}): where its theta wasn't drawn from this prior, posteriors are those of another "
        "one",
        name_of(plan, d), statistic, p_value));
  }
}

// Where the density of a bounded prior ends, as far out as u can be.
void find_theta_at_the_ends(const Plan& plan, const UniformTheta& theta, DatasetFaults& found) {
  constexpr double end = 1e-6, least = 0.02, grave = 0.05;
  constexpr Index fewest = 5;  // draws have an extreme, too, which bounds may be taken from
  for (Index d = 0; d < theta.f.cols(); ++d) {
    const inference::Marginal& marginal = plan.study.prior[static_cast<std::size_t>(d)];
    if (marginal.is_unbounded()) continue;
    const auto f = theta.f.col(d).array();
    const Index count = std::max((f < end).count(), (f > 1.0 - end).count());
    const double share = static_cast<double>(count) / static_cast<double>(f.size());
    if (count < fewest || share < least) continue;
    found.are_grave |= share > grave;
    found.faults.push_back(fmt::format(
        "{0:.2g} of {1} in the dataset lie at an end of its prior, [{2}, {3}], as those of a grid "
        "do, where a posterior's density is cut: widen prior.{1} by half of a step between values",
        share, marginal.name, marginal.lower(), marginal.upper()));
  }
}

// The pair whose F correlate most: with a deviation of 1 / sqrt(n) where they don't, nearly normal
// for few rows, since F is bounded.
void find_correlated_theta(const Plan& plan, const UniformTheta& theta, DatasetFaults& found) {
  constexpr Index fewest = 20;
  constexpr double rounding = 1e-9;
  const Index dimension = theta.f.cols(), num_pairs = dimension * (dimension - 1) / 2;
  if (num_pairs == 0 || theta.num_different < fewest) return;
  RowMatrix centered = theta.f.rowwise() - theta.f.colwise().mean().eval();
  for (Index d = 0; d < dimension; ++d) {
    const bool is_constant = centered.col(d).cwiseAbs().maxCoeff() < rounding;
    centered.col(d) /= is_constant ? HUGE_VAL : centered.col(d).norm();
  }
  const RowMatrix correlations = centered.transpose() * centered;
  Index first = 0, second = 0;
  double largest = 0.0;
  for (Index d = 0; d < dimension; ++d) {
    for (Index e = d + 1; e < dimension; ++e) {
      if (!(std::abs(correlations(d, e)) > std::abs(largest))) continue;
      first = d;
      second = e;
      largest = correlations(d, e);
    }
  }
  const double p_value =
      std::erfc(std::abs(largest) * std::sqrt(0.5 * static_cast<double>(theta.num_different)));
  if (inference::corrected(p_value, num_pairs) >= kFalseAlarmRate) return;
  found.are_grave |= std::abs(largest) > kGraveCorrelation;
  found.faults.push_back(fmt::format(
      "{} and {} of the dataset are correlated ({:.2f} between F of them, p = {:.1g}), and the "
      "prior draws each by itself: where theta wasn't drawn from this prior, posteriors are those "
      "of another one",
      name_of(plan, first), name_of(plan, second), largest, p_value));
}

void find_foreign_theta(const Plan& plan, std::uint64_t seed, Index count, DatasetFaults& found) {
  const UniformTheta theta = uniform_theta(plan, seed, count);
  if (theta.f.rows() == 0) return;
  find_theta_at_the_ends(plan, theta, found);
  find_other_marginals(plan, theta, found);
  find_correlated_theta(plan, theta, found);
}

// To six digits: independent rows of rounded theta may be the same, x with them.
bool is_rounded(const RowMatrix& theta) {
  return std::ranges::all_of(theta.reshaped(), [](double value) {
    return std::stod(fmt::format("{:.6g}", value)) == value;
  });
}

void find_copies(const DatasetFile& dataset, std::vector<Index> rows, DatasetFaults& found) {
  std::ranges::sort(rows);          // as the file has them, which is faster read
  std::set<std::string> different;  // hashes: rows may have very many features
  constexpr std::size_t block = 256;
  bool are_rounded = true;
  for (std::size_t begin = 0; begin < rows.size(); begin += block) {
    const auto some = std::span(rows).subspan(begin, std::min(block, rows.size() - begin));
    const RowMatrix theta = dataset.theta(some), x = dataset.x(some);
    are_rounded = are_rounded && is_rounded(theta);
    for (Index i = 0; i < theta.rows(); ++i) {
      Hasher row;
      row.add_bytes(theta.row(i).data(), static_cast<std::size_t>(theta.cols()) * sizeof(double));
      row.add_bytes(x.row(i).data(), static_cast<std::size_t>(x.cols()) * sizeof(double));
      different.insert(row.hex());
    }
  }
  const Index count = std::ssize(rows), copies = count - std::ssize(different);
  if (copies == 0) return;
  found.are_grave |=
      !are_rounded && static_cast<double>(copies) > kGraveShare * static_cast<double>(count);
  found.faults.push_back(fmt::format(
      "{} of {} rows of the dataset are copies of others, theta and x: they count several times; "
      "leave each in it once",
      copies, count));
}

}  // namespace

DatasetFaults faults_of_dataset(const Plan& plan, const std::vector<std::string>& methods,
                                std::uint64_t seed) {
  DatasetFaults found;
  if (plan.study.source().simulates) return found;
  Index count = 0;  // rows of a method are the first of one that has more
  for (const std::string& method : methods) {
    count = std::max(count, plan.study.method(method).algorithm.num_simulations);
  }
  find_foreign_theta(plan, seed, std::min(count, kMostRows), found);
  const DatasetFile dataset = open_dataset(plan.study);
  const Index num_compared = std::min(count, kMostCompared);
  find_copies(dataset, dataset_rows(seed, dataset.num_rows(), num_compared), found);
  return found;
}

}  // namespace npdr::pipeline
