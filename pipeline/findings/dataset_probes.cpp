#include "pipeline/findings/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>

#include "core/text.h"
#include "inference/diagnostics/levels.h"
#include "inference/prior.h"
#include "pipeline/sources/source.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostRows = 10'000, kMostCompared = 100'000;

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

std::string hash_of(const Vector& values) {
  Hasher hasher;
  hasher.add_bytes(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
  return hasher.hex();
}

// Rows of one theta, those that are finite: the others have failed.
struct RowsOfTheta {
  Index count = 0;
  std::set<std::string> different;  // hashes of x, which may have very many features
};

struct RowCopies {
  std::map<std::string, RowsOfTheta> rows;
  std::vector<std::vector<double>> values;  // of each parameter
  Index count = 0;

  void observe(const Vector& theta, const Vector& x) {
    if (!x.allFinite()) return;
    ++count;
    values.resize(static_cast<std::size_t>(theta.size()));
    for (std::size_t d = 0; d < values.size(); ++d) {
      values[d].push_back(theta(static_cast<Index>(d)));
    }
    RowsOfTheta& same = rows[hash_of(theta)];
    ++same.count;
    same.different.insert(hash_of(x));
  }

  Index num_copies() const {
    Index copies = 0;
    for (const auto& [theta, same] : rows) copies += same.count - std::ssize(same.different);
    return copies;
  }

  // Of rows that were drawn by themselves: those of rounded theta may be the same, x with them.
  double expected_copies() const {
    double num_pairs = 0.5 * static_cast<double>(count) * static_cast<double>(count);
    for (const std::vector<double>& of_one : values) {
      const auto levels = inference::levels_of(Vector::Map(of_one.data(), std::ssize(of_one)));
      num_pairs /= static_cast<double>(levels.size());
    }
    return num_pairs;
  }

  // Simulations of one theta whose x has few values may agree, but not all of nearly every theta.
  bool agree_by_chance() const {
    constexpr double nearly_all = 0.9;
    Index repeated = 0, all_same = 0;
    for (const auto& [theta, same] : rows) {
      if (same.count == 1) continue;
      ++repeated;
      if (same.different.size() == 1) ++all_same;
    }
    return static_cast<double>(all_same) < nearly_all * static_cast<double>(repeated);
  }
};

void find_copies(const DatasetFile& dataset, std::vector<Index> rows, Findings& found) {
  constexpr double grave = 0.05, by_chance = 10.0;
  constexpr std::size_t block = 256;
  std::ranges::sort(rows);  // as the file has them, which is faster read
  RowCopies all;
  for (std::size_t begin = 0; begin < rows.size(); begin += block) {
    const auto some = std::span(rows).subspan(begin, std::min(block, rows.size() - begin));
    const RowMatrix theta = dataset.theta(some), x = dataset.x(some);
    for (Index i = 0; i < theta.rows(); ++i) {
      all.observe(theta.row(i).transpose(), x.row(i).transpose());
    }
  }
  const Index copies = all.num_copies();
  if (copies == 0 || all.agree_by_chance()) return;
  const bool is_grave =
      static_cast<double>(copies) >
      std::max(grave * static_cast<double>(all.count), by_chance * all.expected_copies());
  found.push_back({.severity = is_grave ? Severity::wrong : Severity::suspicious,
                   .what = fmt::format("{} of {} rows of the dataset are copies of others, theta "
                                       "and x: they count several times; leave each in it once",
                                       copies, all.count)});
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
  const Index num_compared = std::min(count, kMostCompared);
  find_copies(dataset, dataset_rows(seed, dataset.num_rows(), num_compared), found);
  return found;
}

template <>
Finding judge<Check::dataset>(const MethodResults& m) {
  const Findings& found = m.data.dataset;
  std::vector<std::string> words;
  for (const Finding& finding : found) words.push_back(finding.what);
  return std::ranges::count(found, Severity::wrong, &Finding::severity) == 0
             ? passes("")
             : fails("its rows AREN'T what they should be", join(words, "; "));
}

}  // namespace npdr::pipeline
