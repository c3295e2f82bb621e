#include "pipeline/findings/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <span>

#include "inference/diagnostics/row_faults.h"
#include "inference/prior.h"
#include "pipeline/sources/first_rows.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostRows = 10'000;

// What lies in the prior of the first `count` rows that are trained on.
RowMatrix theta_in_prior(const Plan& plan, std::uint64_t seed, Index count) {
  const inference::Prior prior(plan.study.prior);
  const RowMatrix theta = *plan.source->theta(seed, count);
  std::vector<Index> inside;
  for (Index i = 0; i < theta.rows(); ++i) {
    if (prior.contains(theta.row(i).transpose())) inside.push_back(i);
  }
  return theta(inside, Eigen::all);
}

// Of the file, in its order, which is faster read.
RowsTogether rows_together(const DatasetFile& dataset, std::vector<Index> rows) {
  constexpr std::size_t block = 256;
  std::ranges::sort(rows);
  RowsTogether all{.theta = RowMatrix(std::ssize(rows), std::ssize(dataset.parameters())),
                   .x = RowMatrixF(std::ssize(rows), std::ssize(dataset.features())),
                   .features = dataset.features()};
  for (std::size_t begin = 0; begin < rows.size(); begin += block) {
    const auto some = std::span(rows).subspan(begin, std::min(block, rows.size() - begin));
    const auto at = static_cast<Index>(begin);
    all.theta.middleRows(at, std::ssize(some)) = dataset.theta(some);
    all.x.middleRows(at, std::ssize(some)) = dataset.x(some).cast<float>();
  }
  for (const Index row : rows) all.numbers.push_back(row + 1);
  return all;
}

Findings find_twice(const RowsTogether& rows) {
  constexpr double grave = 0.05, by_chance = 10.0;
  const inference::RowCopies copies = inference::find_copies(rows.theta, rows.x);
  const Index count = copies.num_exact + copies.num_near;
  if (count == 0) return {};
  const bool is_grave =
      static_cast<double>(count) >
      std::max(grave * static_cast<double>(copies.num_rows), by_chance * copies.expected);
  const std::string near =
      copies.num_near == 0 ? "" : fmt::format(", {} of them to a thousandth", copies.num_near);
  return {{.id = "copies",
           .severity = is_grave ? Severity::wrong : Severity::suspicious,
           .what = "rows of the dataset are copies of others, so that they count several times",
           .evidence = fmt::format("{} of {} rows{} (by chance: {:.0f})", count, copies.num_rows,
                                   near, copies.expected),
           .advice = "Leave each row in the dataset once"}};
}

}  // namespace

Findings find_in_dataset(const Plan& plan, const std::vector<std::string>& methods,
                         std::uint64_t seed) {
  if (plan.study.source().simulates) return {};
  Index count = 0;  // rows of a method are the first of one that has more
  for (const std::string& method : methods) {
    count = std::max(count, plan.study.method(method).algorithm.num_simulations);
  }
  const RowMatrix theta = theta_in_prior(plan, seed, std::min(count, kMostRows));
  Findings found;
  if (theta.rows() > 0) found = find_in_theta(theta, inference::Prior(plan.study.prior));
  const DatasetFile dataset = open_dataset(plan.study);
  const Index num_compared = std::min(count, num_rows_together(std::ssize(dataset.features())));
  const RowsTogether rows =
      rows_together(dataset, dataset_rows(seed, dataset.num_rows(), num_compared));
  append(found, find_twice(rows));
  append(found, find_apart(rows));
  return found;
}

template <>
Findings judge<Check::dataset>(const MethodResults& m) {
  Findings found = m.data.dataset;
  const bool is_wrong = std::ranges::count(found, Severity::wrong, &Finding::severity) > 0;
  if (!is_wrong) found.push_back(passes({}));
  std::ranges::stable_sort(found, std::greater(), &Finding::severity);
  return found;
}

}  // namespace npdr::pipeline
