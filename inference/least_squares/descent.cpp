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
constexpr double kOwnMove = 0.25;          // of unknowns of blocks
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

Index rows_of_step(const Simulations& simulations, Index dimension) {
  return simulations.rows_of_slopes(dimension) + static_cast<Index>(kNumTrials);
}

Index rows_of_curvature(const Simulations& simulations, Index dimension) {
  return 2 * simulations.rows_of_slopes(dimension);
}

// Normal equations of each, and the next moves.
void differentiate(Simulations& simulations, const std::vector<Search*>& searches) {
  const LeastSquaresProblem& problem = simulations.problem();
  std::vector<RowMatrix> slopes = simulations.slopes(searches);
  for (std::size_t s = 0; s < searches.size(); ++s) {
    Search& search = *searches[s];
    const Point& at = search.at;
    search.normal = {weighted(problem.noise, at, std::move(slopes[s])), at.unknowns,
                     problem.block_begins, problem.num_rollouts};
    constexpr double share = 0.1, least = 1e-4, most = 0.05;  // of a conditional deviation; of u
    search.moves = (share * (search.normal.curvature().diagonal().array() + 1.0).rsqrt())
                       .cwiseMax(least)
                       .cwiseMin(most);
  }
}

// Some damped steps of each, the best of which is taken; with none the damping grows, as long as
// more rows than `reserve` are left.
void advance(Simulations& simulations, std::vector<Search*> searches, Index reserve) {
  while (!searches.empty() &&
         simulations.num_left() >= reserve + std::ssize(searches) * Index{kNumTrials}) {
    RowMatrix trials(std::ssize(searches) * static_cast<Index>(kNumTrials),
                     searches.front()->at.unknowns.size());
    for (Index i = 0; i < trials.rows(); ++i) {
      const Search& search = *searches[static_cast<std::size_t>(i) / kNumTrials];
      const auto power = static_cast<double>(static_cast<std::size_t>(i) % kNumTrials) - 1.0;
      const double damping = search.damping * std::pow(kDampingRatio, power);
      trials.row(i) = (search.at.unknowns + search.normal.step(damping, kLongestStep)).transpose();
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

bool have_met(const Search& a, const Search& b) {
  return (a.u() - b.u()).lpNorm<Eigen::Infinity>() < kSame;
}

// The best first, without those that have met a better one.
void merge(std::vector<Search>& searches) {
  std::ranges::stable_sort(searches, {}, [](const Search& s) { return s.at.cost; });
  std::vector<Search> kept;
  for (Search& search : searches) {
    const bool is_new =
        std::ranges::none_of(kept, [&](const Search& other) { return have_met(search, other); });
    if (is_new) kept.push_back(std::move(search));
  }
  searches = std::move(kept);
}

}  // namespace

void Simulations::for_each(const RowMatrix& unknowns,
                           const std::function<void(Index, RowMatrix)>& visit) {
  for (Index begin = 0, block = 0; begin < unknowns.rows(); begin += block) {
    block = std::min(most_rows_, unknowns.rows() - begin);
    const RowMatrixF rows = problem_.errors(unknowns.middleRows(begin, block));
    most_rows_ = std::max<Index>(1, kMostValues / std::max<Index>(1, rows.cols()));
    num_rows_ += block;
    for (Index i = 0; i < block; ++i) {
      if (!rows.row(i).allFinite()) ++num_failed_;
      visit(begin + i, shaped(rows.row(i)));
    }
  }
}

std::vector<Point> Simulations::points(const RowMatrix& unknowns,
                                       const std::function<Vector(Index)>& guess) {
  std::vector<Point> all(static_cast<std::size_t>(unknowns.rows()));
  for_each(unknowns, [&](Index i, RowMatrix errors) {
    Point& point = all[static_cast<std::size_t>(i)];
    point.unknowns = unknowns.row(i).transpose();
    if (errors.size() == 0) return;
    point.scales = problem_.noise.scales(errors, guess(i));
    point.cost = problem_.noise.cost(errors, point.scales) + 0.5 * point.unknowns.squaredNorm();
    point.errors = std::move(errors);
  });
  return all;
}

std::vector<RowMatrix> Simulations::slopes(const std::vector<Search*>& searches) {
  std::vector<RowMatrix> slopes(searches.size());
  for_each_moved(searches, 1.0, [&](std::size_t s, Index d, const RowMatrix& errors) {
    const Search& search = *searches[s];
    if (slopes[s].size() == 0) {
      slopes[s].setZero(search.at.errors.size(), rows_of_slopes(search.moves.size()));
    }
    if (errors.size() == 0) return;
    slopes[s].col(d) = (errors - search.at.errors).reshaped<Eigen::RowMajor>() / move_of(search, d);
  });
  return slopes;
}

RowMatrix Simulations::central_slopes(Search& search) {
  const Index columns = rows_of_slopes(search.moves.size());
  std::vector<RowMatrix> above(static_cast<std::size_t>(columns));
  RowMatrix slopes = RowMatrix::Zero(search.at.errors.size(), columns);
  for_each_moved({&search}, 1.0, [&](std::size_t, Index d, const RowMatrix& errors) {
    above[static_cast<std::size_t>(d)] = errors;
  });
  for_each_moved({&search}, -1.0, [&](std::size_t, Index d, const RowMatrix& errors) {
    const RowMatrix& other = above[static_cast<std::size_t>(d)];
    const double moves = (errors.size() > 0 ? 1.0 : 0.0) + (other.size() > 0 ? 1.0 : 0.0);
    if (moves == 0.0) return;
    const RowMatrix& high = other.size() > 0 ? other : search.at.errors;
    const RowMatrix& low = errors.size() > 0 ? errors : search.at.errors;
    slopes.col(d) = (high - low).reshaped<Eigen::RowMajor>() / (moves * move_of(search, d));
  });
  return slopes;
}

void Simulations::for_each_moved(
    const std::vector<Search*>& searches, double factor,
    const std::function<void(std::size_t, Index, const RowMatrix&)>& visit) {
  const Index dimension = searches.front()->moves.size();
  const Index columns = rows_of_slopes(dimension), own = columns - dimension;
  RowMatrix moved(std::ssize(searches) * columns, searches.front()->at.unknowns.size());
  for (std::size_t s = 0; s < searches.size(); ++s) {
    const Search& search = *searches[s];
    auto block = moved.middleRows(static_cast<Index>(s) * columns, columns);
    block = search.at.unknowns.transpose().replicate(columns, 1);
    for (Index d = 0; d < dimension; ++d) block(d, d) += factor * search.moves(d);
    for (Index j = dimension; j < moved.cols(); ++j) {
      block(dimension + (j - dimension) % own, j) += factor * kOwnMove;
    }
  }
  for_each(moved, [&](Index i, const RowMatrix& errors) {
    visit(static_cast<std::size_t>(i / columns), i % columns, errors);
  });
}

double Simulations::move_of(const Search& search, Index column) {
  return column < search.moves.size() ? search.moves(column) : kOwnMove;
}

RowMatrix Simulations::completed(const RowMatrix& u) const {
  const Index blocks = problem_.num_rollouts * std::ssize(problem_.block_begins);
  RowMatrix unknowns = RowMatrix::Zero(u.rows(), u.cols() + blocks * num_own());
  unknowns.leftCols(u.cols()) = u;
  return unknowns;
}

RowMatrix Simulations::shaped(const VectorF& row) const {
  if (!row.allFinite()) return {};
  const Index channels = problem_.noise.num_channels();
  return row.cast<double>().reshaped<Eigen::RowMajor>(row.size() / channels, channels);
}

WeightedErrors weighted(const StudentErrors& noise, const Point& at, RowMatrix slopes) {
  const Vector precisions = at.scales.cwiseInverse();
  return {std::move(slopes),
          noise.weights(at.errors, at.scales) * precisions.cwiseAbs2().asDiagonal(),
          noise.scores(at.errors, at.scales) * precisions.asDiagonal()};
}

RowMatrix best_rows(Simulations& simulations, const RowMatrix& u, Index count) {
  const StudentErrors& noise = simulations.problem().noise;
  std::vector<Index> rows;
  Vector costs(u.rows());
  simulations.for_each(simulations.completed(u), [&](Index i, const RowMatrix& errors) {
    if (errors.size() == 0) return;
    costs(i) = noise.cost(errors, noise.scales(errors)) + 0.5 * u.row(i).squaredNorm();
    rows.push_back(i);
  });
  std::ranges::stable_sort(rows, {}, [&](Index i) { return costs(i); });
  rows.resize(std::min(rows.size(), static_cast<std::size_t>(count)));
  return u(rows, Eigen::all);
}

Index rows_of_start(const Simulations& simulations, Index dimension) {
  return kStepsBeforeHalving * rows_of_step(simulations, dimension) +
         rows_of_curvature(simulations, dimension);
}

std::vector<Search> descend(Simulations& simulations, const RowMatrix& starts, Index max_steps) {
  std::vector<Search> searches;
  for (Point& point :
       simulations.points(simulations.completed(starts), [](Index) { return Vector(); })) {
    if (point.cost == kInfinity) continue;
    searches.push_back({std::move(point), {}, Vector::Constant(starts.cols(), kFirstMove)});
  }
  const Index dimension = starts.cols(), of_step = rows_of_step(simulations, dimension);
  merge(searches);
  const Index most =
      std::max<Index>(1, simulations.num_left() / rows_of_start(simulations, dimension));
  searches.resize(std::min(searches.size(), static_cast<std::size_t>(most)));
  for (Index i = 0; i < max_steps; ++i) {
    merge(searches);
    if (i > 0 && i <= 2 * kStepsBeforeHalving && i % kStepsBeforeHalving == 0) {
      const std::size_t half = (searches.size() + 1) / 2;
      searches.resize(std::min(searches.size(), std::max(half, kFewestStarts)));
    }
    std::vector<Search*> moving = active(searches);
    const Index reserve = std::ssize(searches) * rows_of_curvature(simulations, dimension);
    if (moving.empty() || simulations.num_left() < std::ssize(moving) * of_step + reserve) break;
    differentiate(simulations, moving);
    for (Search* search : moving) search->is_done = search->normal.promised() < kConverged;
    std::erase_if(moving, [](const Search* search) { return search->is_done; });
    advance(simulations, moving, reserve);
  }
  merge(searches);
  return searches;
}

}  // namespace npdr::inference
