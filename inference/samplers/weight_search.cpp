#include "inference/samplers/weight_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "core/decompositions.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "inference/nearest_rows.h"
#include "inference/samplers/importance_constants.h"
#include "inference/samplers/step_length.h"
#include "inference/standard_normal.h"

namespace npdr::inference {
namespace {

// All by hand: a search only proposes where to draw, and draws tell how much is there.
constexpr Index kNeighbors = 12;     // of a point that must be a local maximum
constexpr Index kMostPoints = 4000;  // that are looked at: half a second
constexpr double kWantedRate = 0.25;
constexpr double kGain = 0.6;        // of the steps' length by a step
constexpr Index kMostPlaces = 20;    // that are told apart
constexpr double kInflation = 1.5;   // of the deviations that a searcher has found
constexpr double kLeastRatio = 4.0;  // of w to its mean

Stream stream_of(StreamId id, Index searcher) {
  id.row = static_cast<std::uint64_t>(searcher);
  return Stream(id);
}

Eigen::MatrixXd covariance_of(const WeightSearch& search, Index i) {
  const Index d = search.u.cols();
  return Eigen::Map<const Eigen::MatrixXd>(search.covariance.row(i).data(), d, d);
}

// Whether none of the rows nearest to row i has a larger weight, and their median distance.
struct Peak {
  bool is_highest;
  double distance;
};
Peak peak_at(const RowMatrix& u, const Vector& log_weight, Index i) {
  const std::vector<Index> near = nearest_rows(u, i, kNeighbors);
  std::vector<double> distances;
  for (const Index k : near) distances.push_back((u.row(k) - u.row(i)).norm());
  const auto is_lower = [&](Index k) { return log_weight(k) <= log_weight(i); };
  return {std::ranges::all_of(near, is_lower), near.empty() ? 1.0 : upper_median(distances)};
}

}  // namespace

Index num_search_steps(Index dimension) { return 30 + 15 * std::min<Index>(dimension, 12); }

WeightSearch begin_search(const RowMatrix& u, const Vector& log_likelihood,
                          const Vector& log_weight, Index most) {
  std::vector<Index> finite;
  for (Index i = 0; i < u.rows() && std::ssize(finite) < kMostPoints; ++i) {
    if (std::isfinite(log_likelihood(i)) && std::isfinite(log_weight(i))) finite.push_back(i);
  }
  const RowMatrix points = u(finite, Eigen::all);
  const Vector weights = log_weight(finite);
  std::vector<Peak> peaks(finite.size());
  parallel_for(points.rows(),
               [&](Index i) { peaks[static_cast<std::size_t>(i)] = peak_at(points, weights, i); });
  std::vector<Index> starts;
  for (Index i = 0; i < points.rows(); ++i) {
    if (peaks[static_cast<std::size_t>(i)].is_highest) starts.push_back(i);
  }
  std::ranges::stable_sort(starts, std::greater(), [&](Index i) { return weights(i); });
  starts.resize(std::min(starts.size(), static_cast<std::size_t>(most)));

  const auto count = std::ssize(starts);
  const Index d = u.cols();
  WeightSearch search{.u = points(starts, Eigen::all),
                      .log_likelihood = Vector(log_likelihood(finite))(starts),
                      .log_weight = weights(starts),
                      .log_step = Vector(count),
                      .covariance = RowMatrix(count, d * d)};
  for (Index i = 0; i < count; ++i) {
    const double distance =
        peaks[static_cast<std::size_t>(starts[static_cast<std::size_t>(i)])].distance;
    search.log_step(i) =
        std::log(std::max(0.3 * distance, 1e-9) / std::sqrt(static_cast<double>(d)));
    search.covariance.row(i) = Eigen::MatrixXd::Identity(d, d).reshaped().transpose();
  }
  return search;
}

RowMatrix propose_search_steps(const WeightSearch& search, const StreamId& id) {
  RowMatrix proposed = search.u;
  for (Index i = 0; i < proposed.rows(); ++i) {
    Stream stream = stream_of(id, i);
    Vector normal(proposed.cols());
    for (double& value : normal) value = stream.normal();
    proposed.row(i) +=
        std::exp(search.log_step(i)) * Cholesky(covariance_of(search, i)).times(normal).transpose();
  }
  return proposed;
}

void take_search_steps(WeightSearch& search, const RowMatrix& proposed,
                       const Vector& log_likelihood, const Vector& log_weight, const StreamId& id) {
  const Index d = search.u.cols();
  const double rate = 2.0 / (static_cast<double>(d * d) + 6.0);
  for (Index i = 0; i < proposed.rows(); ++i) {
    const bool is_taken =
        std::isfinite(log_likelihood(i)) && std::isfinite(log_weight(i)) &&
        std::log(stream_of(id, i).uniform()) < log_weight(i) - search.log_weight(i);
    if (is_taken) {
      const Vector step =
          (proposed.row(i) - search.u.row(i)).transpose() / std::exp(search.log_step(i));
      const Eigen::MatrixXd covariance =
          (1.0 - rate) * covariance_of(search, i) + rate * step * step.transpose();
      search.covariance.row(i) = covariance.reshaped().transpose();
      search.u.row(i) = proposed.row(i);
      search.log_likelihood(i) = log_likelihood(i);
      search.log_weight(i) = log_weight(i);
    }
    search.log_step(i) += kGain * ((is_taken ? 1.0 : 0.0) - kWantedRate);
  }
  ++search.num_steps;
}

std::vector<FlowProposal> found_places(const WeightSearch& search, double power,
                                       double log_evidence) {
  const Index d = search.u.cols();
  const auto dimension = static_cast<double>(d);
  const Vector log_density = log_standard_normal<double>(search.u) + power * search.log_likelihood;
  std::vector<FlowProposal> places;
  std::vector<std::pair<double, FlowProposal>> found;
  for (Index i = 0; i < search.u.rows(); ++i) {
    const double scale = std::exp(search.log_step(i)) * std::sqrt(dimension) / kBestStep;
    const Cholesky factor(scale * scale * covariance_of(search, i));
    if (!factor.is_positive_definite()) continue;
    const double log_share = log_density(i) - log_evidence + factor.half_log_det() +
                             0.5 * dimension * (1.0 + std::log(2.0 * std::numbers::pi));
    if (!(log_share > std::log(kLeastFound))) continue;
    if (!(search.log_weight(i) > log_evidence + std::log(kLeastRatio))) continue;
    found.emplace_back(log_share, FlowProposal{.mean = search.u.row(i).transpose(),
                                               .factor = kInflation * factor.lower(),
                                               .network = {}});
  }
  std::ranges::stable_sort(found, std::greater(), [](const auto& f) { return f.first; });
  for (auto& [share, place] : found) {
    const bool is_known = std::ranges::any_of(places, [&](const FlowProposal& other) {
      const Vector away = other.mean - place.mean;
      return other.factor.triangularView<Eigen::Lower>().solve(away).squaredNorm() < dimension;
    });
    if (!is_known && std::ssize(places) < kMostPlaces) places.push_back(std::move(place));
  }
  return places;
}

}  // namespace npdr::inference
