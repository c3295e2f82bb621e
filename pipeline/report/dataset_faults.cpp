#include "pipeline/report/dataset_faults.h"

#include <fmt/format.h>

#include <algorithm>
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
constexpr double kGraveDistance = 0.05, kGraveShare = 0.05;

// The first `count` rows that are trained on, but for those outside of the prior, in the space in
// which it is N(0, I).
RowMatrix normal_theta(const Plan& plan, std::uint64_t seed, Index count) {
  const inference::Prior prior(plan.study.prior);
  const RowMatrix all = *plan.source->theta(seed, count);
  RowMatrix inside(all.rows(), all.cols());
  Index num_inside = 0;
  for (Index i = 0; i < all.rows(); ++i) {
    if (prior.contains(all.row(i).transpose())) inside.row(num_inside++) = all.row(i);
  }
  return prior.to_normal(inside.topRows(num_inside));
}

// How far F of theta may be off: half of a step where values are few, such as whole numbers.
double distance_allowed(const Eigen::Ref<const Vector>& values) {
  const std::set<double> different(values.begin(), values.end());
  const auto count = static_cast<double>(different.size());
  return kGraveDistance + (count > 1.0 ? 0.5 / count : 0.0);
}

// To six digits: independent rows of rounded theta may be the same, x with them.
bool is_rounded(const RowMatrix& theta) {
  return std::ranges::all_of(theta.reshaped(), [](double value) {
    return std::stod(fmt::format("{:.6g}", value)) == value;
  });
}

void find_foreign_theta(const Plan& plan, const RowMatrix& u, DatasetFaults& found) {
  if (u.rows() == 0) return;
  for (Index d = 0; d < u.cols(); ++d) {
    const Vector uniform = u.col(d).unaryExpr([](double v) { return normal_cdf(v); });
    const auto test = inference::test_kolmogorov_smirnov(uniform);
    if (inference::corrected(test.p_value, u.cols()) >= kFalseAlarmRate) continue;
    found.are_grave |= test.statistic > distance_allowed(u.col(d));
    found.faults.push_back(fmt::format(
        "{} of the dataset isn't distributed as the prior says (Kolmogorov-Smirnov {:.2f}, p = "
        "{:.1g}): where its theta wasn't drawn from this prior, posteriors are those of another "
        "one",
        plan.study.prior[static_cast<std::size_t>(d)].name, test.statistic, test.p_value));
  }
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
  find_foreign_theta(plan, normal_theta(plan, seed, std::min(count, kMostRows)), found);
  const DatasetFile dataset = open_dataset(plan.study);
  const Index num_compared = std::min(count, kMostCompared);
  find_copies(dataset, dataset_rows(seed, dataset.num_rows(), num_compared), found);
  return found;
}

}  // namespace npdr::pipeline
