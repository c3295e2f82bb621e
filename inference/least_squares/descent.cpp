#include "inference/least_squares/descent.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace npdr::inference {
namespace {

constexpr double kConverged = 0.01;        // [nats] that another step would take away
constexpr double kSame = 0.05;             // of u, between starts that have met
constexpr double kLongestStep = 2.0;       // of u
constexpr double kFirstMove = 1e-3;        // of u, for differences
constexpr std::size_t kNumTrials = 3;      // damped steps that are tried at once
constexpr double kDampingRatio = 8.0;      // between them
constexpr double kMostDamping = 1e8;       // no step helps
constexpr Index kStepsBeforeHalving = 6;   // of all starts
constexpr std::size_t kFewestStarts = 3;   // that go on
constexpr Index kMostValues = 50'000'000;  // errors in memory at once

std::vector<Search*> active(std::vector<Search>& searches) {
  std::vector<Search*> found;
  for (Search& search : searches) {
    if (!search.is_done) found.push_back(&search);
  }
  return found;
}

Index rows_of_step(Index dimension) { return dimension + static_cast<Index>(kNumTrials); }

Index rows_of_curvature(Index dimension) { return 2 * dimension; }

// Curvature and gradient of each.
void differentiate(Simulations& simulations, const std::vector<Search*>& searches) {
  const StudentErrors& noise = simulations.problem().noise;
  const std::vector<RowMatrix> slopes = simulations.slopes(searches);
  for (std::size_t s = 0; s < searches.size(); ++s) {
    Search& search = *searches[s];
    const Point& at = search.at;
    const RowMatrix weights = noise.weights(at.errors, at.scales);
    search.curvature = curvature(slopes[s], weights, at.scales);
    const RowMatrix scores =
        noise.scores(at.errors, at.scales) * at.scales.cwiseInverse().asDiagonal();
    search.gradient = slopes[s].transpose() * scores.reshaped<Eigen::RowMajor>() + at.u;
    constexpr double share = 0.1, least = 1e-4, most = 0.05;  // of a conditional deviation; of u
    search.moves = (share * (search.curvature.diagonal().array() + 1.0).rsqrt())
                       .cwiseMax(least)
                       .cwiseMin(most);
  }
}

// A step by the damped normal equations, (D).
Vector step(const Search& search, double damping) {
  RowMatrix normal = with_prior(search.curvature);
  normal.diagonal() *= 1.0 + damping;
  const Vector found = -normal.ldlt().solve(search.gradient);
  return found * std::min(1.0, kLongestStep / std::max(kLongestStep, found.norm()));
}

// [nats] that the undamped step takes away, were errors linear.
double promised(const Search& search) {
  return 0.5 * search.gradient.dot(with_prior(search.curvature).ldlt().solve(search.gradient));
}

// Some damped steps of each, the best of which is taken; with none the damping grows, as long as
// more rows than `reserve` are left.
void advance(Simulations& simulations, std::vector<Search*> searches, Index reserve) {
  while (!searches.empty() &&
         simulations.num_left() >= reserve + std::ssize(searches) * Index{kNumTrials}) {
    RowMatrix trials(std::ssize(searches) * static_cast<Index>(kNumTrials),
                     searches.front()->at.u.size());
    for (Index i = 0; i < trials.rows(); ++i) {
      const Search& search = *searches[static_cast<std::size_t>(i) / kNumTrials];
      const auto power = static_cast<double>(static_cast<std::size_t>(i) % kNumTrials) - 1.0;
      const double damping = search.damping * std::pow(kDampingRatio, power);
      trials.row(i) = (search.at.u + step(search, damping)).transpose();
    }
    std::vector<Point> points = simulations.points(trials, [&](Index i) {
      return searches[static_cast<std::size_t>(i) / kNumTrials]->at.scales;
    });
    std::vector<Search*> again;
    for (std::size_t s = 0; s < searches.size(); ++s) {
      Search& search = *searches[s];
      const auto begin = points.begin() + static_cast<std::ptrdiff_t>(s * kNumTrials);
      const auto best = std::ranges::min_element(begin, begin + kNumTrials, {}, &Point::cost);
      if (best->cost < search.at.cost) {
        search.damping *= std::pow(kDampingRatio, static_cast<double>(best - begin) - 1.0);
        search.damping = std::max(search.damping, 1e-6);
        search.at = std::move(*best);
        continue;
      }
      search.damping *= std::pow(kDampingRatio, static_cast<double>(kNumTrials));
      search.is_done = search.damping > kMostDamping;
      if (!search.is_done) again.push_back(&search);
    }
    searches = std::move(again);
  }
}

bool have_met(const Point& a, const Point& b) {
  return (a.u - b.u).lpNorm<Eigen::Infinity>() < kSame;
}

// The best first, without those that have met a better one.
void merge(std::vector<Search>& searches) {
  std::ranges::stable_sort(searches, {}, [](const Search& s) { return s.at.cost; });
  std::vector<Search> kept;
  for (Search& search : searches) {
    const bool is_new = std::ranges::none_of(
        kept, [&](const Search& other) { return have_met(search.at, other.at); });
    if (is_new) kept.push_back(std::move(search));
  }
  searches = std::move(kept);
}

}  // namespace

void Simulations::for_each(const RowMatrix& u, const std::function<void(Index, RowMatrix)>& visit) {
  for (Index begin = 0, block = 0; begin < u.rows(); begin += block) {
    block = std::min(most_rows_, u.rows() - begin);
    const RowMatrixF rows = problem_.errors(u.middleRows(begin, block));
    most_rows_ = std::max<Index>(1, kMostValues / std::max<Index>(1, rows.cols()));
    num_rows_ += block;
    for (Index i = 0; i < block; ++i) {
      if (!rows.row(i).allFinite()) ++num_failed_;
      visit(begin + i, shaped(rows.row(i)));
    }
  }
}

std::vector<Point> Simulations::points(const RowMatrix& u,
                                       const std::function<Vector(Index)>& guess) {
  std::vector<Point> all(static_cast<std::size_t>(u.rows()));
  for_each(u, [&](Index i, RowMatrix errors) {
    Point& point = all[static_cast<std::size_t>(i)];
    point.u = u.row(i).transpose();
    if (errors.size() == 0) return;
    point.scales = problem_.noise.scales(errors, guess(i));
    point.cost = problem_.noise.cost(errors, point.scales) + 0.5 * point.u.squaredNorm();
    point.errors = std::move(errors);
  });
  return all;
}

std::vector<RowMatrix> Simulations::slopes(const std::vector<Search*>& searches) {
  std::vector<RowMatrix> slopes(searches.size());
  for_each_moved(searches, 1.0, [&](std::size_t s, Index d, const RowMatrix& errors) {
    const Search& search = *searches[s];
    if (slopes[s].size() == 0) slopes[s].setZero(search.at.errors.size(), search.at.u.size());
    if (errors.size() == 0) return;
    slopes[s].col(d) = (errors - search.at.errors).reshaped<Eigen::RowMajor>() / search.moves(d);
  });
  return slopes;
}

RowMatrix Simulations::central_slopes(Search& search) {
  const Index dimension = search.at.u.size();
  std::vector<RowMatrix> above(static_cast<std::size_t>(dimension));
  RowMatrix slopes = RowMatrix::Zero(search.at.errors.size(), dimension);
  for_each_moved({&search}, 1.0, [&](std::size_t, Index d, const RowMatrix& errors) {
    above[static_cast<std::size_t>(d)] = errors;
  });
  for_each_moved({&search}, -1.0, [&](std::size_t, Index d, const RowMatrix& errors) {
    const RowMatrix& other = above[static_cast<std::size_t>(d)];
    const double moves = (errors.size() > 0 ? 1.0 : 0.0) + (other.size() > 0 ? 1.0 : 0.0);
    if (moves == 0.0) return;
    const RowMatrix& high = other.size() > 0 ? other : search.at.errors;
    const RowMatrix& low = errors.size() > 0 ? errors : search.at.errors;
    slopes.col(d) = (high - low).reshaped<Eigen::RowMajor>() / (moves * search.moves(d));
  });
  return slopes;
}

void Simulations::for_each_moved(
    const std::vector<Search*>& searches, double factor,
    const std::function<void(std::size_t, Index, const RowMatrix&)>& visit) {
  const Index dimension = searches.front()->at.u.size();
  RowMatrix moved(std::ssize(searches) * dimension, dimension);
  for (std::size_t s = 0; s < searches.size(); ++s) {
    auto block = moved.middleRows(static_cast<Index>(s) * dimension, dimension);
    block = searches[s]->at.u.transpose().replicate(dimension, 1);
    block.diagonal() += factor * searches[s]->moves;
  }
  for_each(moved, [&](Index i, const RowMatrix& errors) {
    visit(static_cast<std::size_t>(i / dimension), i % dimension, errors);
  });
}

RowMatrix Simulations::shaped(const VectorF& row) const {
  if (!row.allFinite()) return {};
  const Index channels = problem_.noise.num_channels();
  return row.cast<double>().reshaped<Eigen::RowMajor>(row.size() / channels, channels);
}

RowMatrix curvature(const RowMatrix& slopes, const RowMatrix& weights, const Vector& scales) {
  const RowMatrix roots = (weights * scales.cwiseAbs2().cwiseInverse().asDiagonal()).cwiseSqrt();
  const RowMatrix scaled = roots.reshaped<Eigen::RowMajor>().asDiagonal() * slopes;
  return scaled.transpose() * scaled;
}

RowMatrix with_prior(RowMatrix curvature) {
  curvature.diagonal().array() += 1.0;
  return curvature;
}

RowMatrix best_rows(Simulations& simulations, const RowMatrix& u, Index count) {
  const StudentErrors& noise = simulations.problem().noise;
  std::vector<Index> rows;
  Vector costs(u.rows());
  simulations.for_each(u, [&](Index i, const RowMatrix& errors) {
    if (errors.size() == 0) return;
    costs(i) = noise.cost(errors, noise.scales(errors)) + 0.5 * u.row(i).squaredNorm();
    rows.push_back(i);
  });
  std::ranges::stable_sort(rows, {}, [&](Index i) { return costs(i); });
  rows.resize(std::min(rows.size(), static_cast<std::size_t>(count)));
  return u(rows, Eigen::all);
}

Index rows_of_start(Index dimension) {
  return kStepsBeforeHalving * rows_of_step(dimension) + rows_of_curvature(dimension);
}

std::vector<Search> descend(Simulations& simulations, const RowMatrix& starts, Index max_steps) {
  std::vector<Search> searches;
  for (Point& point : simulations.points(starts, [](Index) { return Vector(); })) {
    if (point.cost == kInfinity) continue;
    searches.push_back({std::move(point), {}, {}, Vector::Constant(starts.cols(), kFirstMove)});
  }
  const Index dimension = starts.cols(), of_step = rows_of_step(dimension);
  merge(searches);
  const Index most = std::max<Index>(1, simulations.num_left() / rows_of_start(dimension));
  searches.resize(std::min(searches.size(), static_cast<std::size_t>(most)));
  for (Index i = 0; i < max_steps; ++i) {
    merge(searches);
    if (i > 0 && i <= 2 * kStepsBeforeHalving && i % kStepsBeforeHalving == 0) {
      const std::size_t half = (searches.size() + 1) / 2;
      searches.resize(std::min(searches.size(), std::max(half, kFewestStarts)));
    }
    std::vector<Search*> moving = active(searches);
    const Index reserve = std::ssize(searches) * rows_of_curvature(dimension);
    if (moving.empty() || simulations.num_left() < std::ssize(moving) * of_step + reserve) break;
    differentiate(simulations, moving);
    for (Search* search : moving) search->is_done = promised(*search) < kConverged;
    std::erase_if(moving, [](const Search* search) { return search->is_done; });
    advance(simulations, moving, reserve);
  }
  merge(searches);
  return searches;
}

}  // namespace npdr::inference
