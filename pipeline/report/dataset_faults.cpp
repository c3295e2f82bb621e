#include "pipeline/report/dataset_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <set>
#include <span>

#include "inference/prior.h"
#include "pipeline/sources/dataset_rows.h"
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

// To six digits: independent rows of rounded theta may be the same, x with them.
bool is_rounded(const RowMatrix& theta) {
  return std::ranges::all_of(theta.reshaped(), [](double value) {
    return std::stod(fmt::format("{:.6g}", value)) == value;
  });
}

// Those that are finite; the others have failed. By hashes: rows may have very many features.
struct DifferentRows {
  std::set<std::string> theta, x, both;
  Index count = 0;

  void add(const Vector& of_theta, const Vector& of_x) {
    if (!of_x.allFinite()) return;
    ++count;
    theta.insert(hash_of({&of_theta}));
    x.insert(hash_of({&of_x}));
    both.insert(hash_of({&of_theta, &of_x}));
  }

  Index num_copies() const { return count - std::ssize(both); }

  // Where x has so few values that other theta have the same one, and some of the same theta
  // haven't.
  bool agree_by_chance() const {
    constexpr double nearly_all = 0.9;
    const bool agree =
        static_cast<double>(x.size()) < nearly_all * static_cast<double>(both.size());
    return agree && theta.size() < both.size();
  }

  static std::string hash_of(std::initializer_list<const Vector*> parts) {
    Hasher hasher;
    for (const Vector* part : parts) {
      hasher.add_bytes(part->data(), static_cast<std::size_t>(part->size()) * sizeof(double));
    }
    return hasher.hex();
  }
};

void find_copies(const DatasetFile& dataset, std::vector<Index> rows, DatasetFaults& found) {
  constexpr double grave = 0.05;
  constexpr std::size_t block = 256;
  std::ranges::sort(rows);  // as the file has them, which is faster read
  DifferentRows different;
  bool are_rounded = true;
  for (std::size_t begin = 0; begin < rows.size(); begin += block) {
    const auto some = std::span(rows).subspan(begin, std::min(block, rows.size() - begin));
    const RowMatrix theta = dataset.theta(some), x = dataset.x(some);
    are_rounded = are_rounded && is_rounded(theta);
    for (Index i = 0; i < theta.rows(); ++i) {
      different.add(theta.row(i).transpose(), x.row(i).transpose());
    }
  }
  const Index copies = different.num_copies();
  if (copies == 0 || different.agree_by_chance()) return;
  found.are_grave |=
      !are_rounded && static_cast<double>(copies) > grave * static_cast<double>(different.count);
  found.faults.push_back(fmt::format(
      "{} of {} rows of the dataset are copies of others, theta and x: they count several times; "
      "leave each in it once",
      copies, different.count));
}

}  // namespace

DatasetFaults faults_of_dataset(const Plan& plan, const std::vector<std::string>& methods,
                                std::uint64_t seed) {
  if (plan.study.source().simulates) return {};
  Index count = 0;  // rows of a method are the first of one that has more
  for (const std::string& method : methods) {
    count = std::max(count, plan.study.method(method).algorithm.num_simulations);
  }
  const RowMatrix theta = theta_in_prior(plan, seed, std::min(count, kMostRows));
  DatasetFaults found;
  if (theta.rows() > 0) found = faults_of_theta(theta, inference::Prior(plan.study.prior));
  const DatasetFile dataset = open_dataset(plan.study);
  const Index num_compared = std::min(count, kMostCompared);
  find_copies(dataset, dataset_rows(seed, dataset.num_rows(), num_compared), found);
  return found;
}

}  // namespace npdr::pipeline
