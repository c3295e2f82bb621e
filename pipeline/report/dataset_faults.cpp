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
constexpr Index kFewestCorrelated = 20;
constexpr double kFalseAlarmRate = 1e-4;
constexpr double kGraveDistance = 0.05, kGraveShare = 0.05, kGraveCorrelation = 0.2;
constexpr double kShareAtTheEnds = 0.01;

// To six digits: independent rows of rounded theta may be the same, x with them.
bool is_rounded(const RowMatrix& theta) {
  return std::ranges::all_of(theta.reshaped(), [](double value) {
    return std::stod(fmt::format("{:.6g}", value)) == value;
  });
}

// theta of the first `count` rows that are trained on, but for those outside of the prior, and each
// once that several simulations have: rows of the same theta aren't independent.
RowMatrix different_theta(const Plan& plan, const inference::Prior& prior, std::uint64_t seed,
                          Index count) {
  const RowMatrix all = *plan.source->theta(seed, count);
  const bool may_be_the_same = is_rounded(all);
  std::set<std::vector<double>> seen;
  std::vector<Index> kept;
  for (Index i = 0; i < all.rows(); ++i) {
    if (!prior.contains(all.row(i).transpose())) continue;
    const bool is_new =
        may_be_the_same || seen.emplace(all.row(i).begin(), all.row(i).end()).second;
    if (is_new) kept.push_back(i);
  }
  return all(kept, Eigen::all);
}

// How far F of theta may be off: half of a step where values are few, such as whole numbers.
double distance_allowed(const Eigen::Ref<const Vector>& values) {
  const std::set<double> different(values.begin(), values.end());
  const auto count = static_cast<double>(different.size());
  return kGraveDistance + (count > 1.0 ? 0.5 / count : 0.0);
}

// Where the density of a bounded prior ends, u is as far out as it gets.
void find_theta_at_the_ends(const Plan& plan, const RowMatrix& theta, DatasetFaults& found) {
  for (Index d = 0; d < theta.cols(); ++d) {
    const inference::Marginal& marginal = plan.study.prior[static_cast<std::size_t>(d)];
    const auto values = theta.col(d).array();
    const Index at_ends = (values == marginal.lower() || values == marginal.upper()).count();
    const double share = static_cast<double>(at_ends) / static_cast<double>(theta.rows());
    if (share < kShareAtTheEnds) continue;
    found.are_grave = true;
    found.faults.push_back(fmt::format(
        "{0:.2g} of the dataset's rows have {1} at an end of its prior, [{2}, {3}], as grids have, "
        "where posteriors can't be learned: widen prior.{1} by half of a step between its values",
        share, marginal.name, marginal.lower(), marginal.upper()));
  }
}

// The pair with the largest correlation of F(theta), whose deviation is 1 / sqrt(n) where there is
// none: F is bounded, so nearly normal for few rows.
void find_correlated_theta(const Plan& plan, RowMatrix uniform, DatasetFaults& found) {
  const Index dimension = uniform.cols(), num_pairs = dimension * (dimension - 1) / 2;
  if (num_pairs == 0 || uniform.rows() < kFewestCorrelated) return;
  uniform.rowwise() -= uniform.colwise().mean().eval();
  for (Index d = 0; d < dimension; ++d) uniform.col(d).normalize();  // but of constant ones
  RowMatrix correlations = (uniform.transpose() * uniform).cwiseAbs();
  correlations.diagonal().setZero();
  Index d = 0, e = 0;
  const double largest = correlations.maxCoeff(&d, &e);
  const double p_value = std::erfc(largest * std::sqrt(0.5 * static_cast<double>(uniform.rows())));
  if (inference::corrected(p_value, num_pairs) >= kFalseAlarmRate) return;
  found.are_grave |= largest > kGraveCorrelation;
  const auto& prior = plan.study.prior;
  found.faults.push_back(fmt::format(
      "{} and {} of the dataset are correlated ({:.2f} between F of each, p = {:.1g}), and the "
      "prior "
      "draws every parameter by itself: where theta wasn't drawn from this prior, posteriors are "
      "those of another one",
      prior[static_cast<std::size_t>(d)].name, prior[static_cast<std::size_t>(e)].name, largest,
      p_value));
}

void find_other_marginals(const Plan& plan, const RowMatrix& uniform, DatasetFaults& found) {
  for (Index d = 0; d < uniform.cols(); ++d) {
    const auto test = inference::test_kolmogorov_smirnov(uniform.col(d));
    if (inference::corrected(test.p_value, uniform.cols()) >= kFalseAlarmRate) continue;
    found.are_grave |= test.statistic > distance_allowed(uniform.col(d));
    found.faults.push_back(fmt::format(
        "{} of the dataset isn't distributed as the prior says (Kolmogorov-Smirnov {:.2f}, p = "
        "{:.1g}): where its theta wasn't drawn from this prior, posteriors are those of another "
        "one",
        plan.study.prior[static_cast<std::size_t>(d)].name, test.statistic, test.p_value));
  }
}

void find_foreign_theta(const Plan& plan, std::uint64_t seed, Index count, DatasetFaults& found) {
  const inference::Prior prior(plan.study.prior);
  const RowMatrix theta = different_theta(plan, prior, seed, count);
  if (theta.rows() == 0) return;
  const RowMatrix uniform =
      prior.to_normal(theta).unaryExpr([](double u) { return normal_cdf(u); });
  find_theta_at_the_ends(plan, theta, found);
  find_other_marginals(plan, uniform, found);
  find_correlated_theta(plan, uniform, found);
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
