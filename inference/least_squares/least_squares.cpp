#include "inference/least_squares/least_squares.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "core/parallel.h"
#include "inference/least_squares/long_run_covariance.h"
#include "inference/weighted_population.h"

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
constexpr double kLeastWeight = 1e-4;      // of a minimum in the mixture
constexpr Index kMostValues = 50'000'000;  // errors in memory at once

// A point with its errors.
struct Point {
  Vector u;
  RowMatrix errors;  // (H K, C)
  Vector scales;     // (C)
  double cost = kInfinity;
};

// One start on its way.
struct Search {
  Point at;
  RowMatrix curvature;    // (D, D) of the steps, without the prior's
  Vector gradient;        // (D)
  Vector moves;           // (D) of the next differences
  double damping = 1e-2;  // relative to the curvature
  bool is_done = false;
};

// Costs, derivatives and covariances by simulations, which are counted.
class Problem {
 public:
  Problem(const LeastSquaresProblem& problem, Index max_rows)
      : problem_(problem), max_rows_(max_rows) {}

  Index num_rows = 0, num_failed = 0;

  bool may_go_on() const { return num_rows < max_rows_; }

  // visit(i, errors (H K, C)), in order; of a row that failed no errors.
  void for_each(const RowMatrix& u, const std::function<void(Index, RowMatrix)>& visit) {
    Index block = 1;
    for (Index begin = 0; begin < u.rows(); begin += std::exchange(block, most_rows_)) {
      block = std::min(most_rows_, u.rows() - begin);
      const RowMatrixF rows = problem_.errors(u.middleRows(begin, block));
      most_rows_ = std::max<Index>(1, kMostValues / std::max<Index>(1, rows.cols()));
      num_rows += block;
      for (Index i = 0; i < block; ++i) {
        if (!rows.row(i).allFinite()) ++num_failed;
        visit(begin + i, shaped(rows.row(i)));
      }
    }
  }

  // Points of rows of u; `guess` of scales for row i.
  std::vector<Point> points(const RowMatrix& u, const std::function<Vector(Index)>& guess) {
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

  // (H K C, D) of errors by u at each of some points; 0 where a moved one can't be simulated.
  std::vector<RowMatrix> slopes(const std::vector<Search*>& searches) {
    std::vector<RowMatrix> slopes(searches.size());
    for_each_moved(searches, 1.0, [&](std::size_t s, Index d, const RowMatrix& errors) {
      const Search& search = *searches[s];
      if (slopes[s].size() == 0) slopes[s].setZero(search.at.errors.size(), search.at.u.size());
      if (errors.size() == 0) return;
      slopes[s].col(d) = (errors - search.at.errors).reshaped<Eigen::RowMajor>() / search.moves(d);
    });
    return slopes;
  }

  // The same by central differences.
  RowMatrix central_slopes(Search& search) {
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

  // Of errors whose slopes weigh `weights` (H K, C), (D, D).
  RowMatrix curvature(const RowMatrix& slopes, const RowMatrix& weights,
                      const Vector& scales) const {
    const RowMatrix roots = (weights * scales.cwiseAbs2().cwiseInverse().asDiagonal()).cwiseSqrt();
    const RowMatrix scaled = roots.reshaped<Eigen::RowMajor>().asDiagonal() * slopes;
    return scaled.transpose() * scaled;
  }

  const LeastSquaresProblem& of() const { return problem_; }

 private:
  // visit(search, d, errors), with u_d moved by `factor` times the search's move.
  void for_each_moved(const std::vector<Search*>& searches, double factor,
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

  RowMatrix shaped(const VectorF& row) const {
    if (!row.allFinite()) return {};
    const Index channels = problem_.noise.num_channels();
    return row.cast<double>().reshaped<Eigen::RowMajor>(row.size() / channels, channels);
  }

  const LeastSquaresProblem& problem_;
  Index max_rows_;
  Index most_rows_ = 64;  // of a block, until errors' number is known
};

std::vector<Search*> active(std::vector<Search>& searches) {
  std::vector<Search*> found;
  for (Search& search : searches) {
    if (!search.is_done) found.push_back(&search);
  }
  return found;
}

// Curvature and gradient of each.
void differentiate(Problem& problem, const std::vector<Search*>& searches) {
  const StudentErrors& noise = problem.of().noise;
  const std::vector<RowMatrix> slopes = problem.slopes(searches);
  for (std::size_t s = 0; s < searches.size(); ++s) {
    Search& search = *searches[s];
    const Point& at = search.at;
    const RowMatrix weights = noise.weights(at.errors, at.scales);
    search.curvature = problem.curvature(slopes[s], weights, at.scales);
    const RowMatrix scores =
        noise.scores(at.errors, at.scales) * at.scales.cwiseInverse().asDiagonal();
    search.gradient = slopes[s].transpose() * scores.reshaped<Eigen::RowMajor>() + at.u;
    constexpr double share = 0.1, least = 1e-4, most = 0.05;  // of a deviation
    search.moves = (share * (search.curvature.diagonal().array() + 1.0).rsqrt())
                       .cwiseMax(least)
                       .cwiseMin(most);
  }
}

// By the damped normal equations.
Vector step(const Search& search, double damping) {
  RowMatrix normal = search.curvature;
  normal.diagonal().array() += 1.0;
  normal.diagonal() *= 1.0 + damping;
  const Vector found = -normal.ldlt().solve(search.gradient);
  return found * std::min(1.0, kLongestStep / std::max(kLongestStep, found.norm()));
}

// [nats] that the undamped step takes away, were errors linear.
double promised(const Search& search) {
  RowMatrix normal = search.curvature;
  normal.diagonal().array() += 1.0;
  return 0.5 * search.gradient.dot(normal.ldlt().solve(search.gradient));
}

// Some damped steps of each, the best of which is taken; with none the damping grows.
void advance(Problem& problem, std::vector<Search*> searches) {
  while (!searches.empty()) {
    RowMatrix trials(std::ssize(searches) * static_cast<Index>(kNumTrials),
                     searches.front()->at.u.size());
    for (Index i = 0; i < trials.rows(); ++i) {
      const Search& search = *searches[static_cast<std::size_t>(i) / kNumTrials];
      const auto power = static_cast<double>(static_cast<std::size_t>(i) % kNumTrials) - 1.0;
      const double damping = search.damping * std::pow(kDampingRatio, power);
      trials.row(i) = (search.at.u + step(search, damping)).transpose();
    }
    std::vector<Point> points = problem.points(trials, [&](Index i) {
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

// A minimum, and the power to which its cost counts.
struct Curved {
  Minimum minimum;
  double power = 1.0;
};

// Sums of scores by u of each step, (H K, D).
RowMatrix scores_of_steps(const StudentErrors& noise, const Point& at, const RowMatrix& slopes) {
  const RowMatrix scores =
      noise.scores(at.errors, at.scales) * at.scales.cwiseInverse().asDiagonal();
  RowMatrix of_steps(at.errors.rows(), slopes.cols());
  const Index channels = scores.cols();
  for (Index t = 0; t < of_steps.rows(); ++t) {
    of_steps.row(t) = scores.row(t) * slopes.middleRows(t * channels, channels);
  }
  return of_steps;
}

// R: diagonal, (D).
Vector curvature_of_rounding(const Problem& problem, const Search& search,
                             const Vector& curvatures) {
  const Vector& rounding = problem.of().rounding;
  if (rounding.size() == 0) return Vector::Zero(search.moves.size());
  const auto steps = static_cast<double>(search.at.errors.rows());
  const double sum =
      steps *
      (curvatures.array() * rounding.array().square() / search.at.scales.array().square()).sum();
  return 0.5 * sum * search.moves.array().square().inverse();
}

// Shares of information that are kept, as a matrix F of P = F P F^T.
RowMatrix kept_by(const RowMatrix& a, const Vector& of_rounding) {
  constexpr double least = 10.0;
  const Index dimension = a.rows();
  if (!(of_rounding.minCoeff() > 0.0)) return RowMatrix::Identity(dimension, dimension);
  const Vector root = of_rounding.cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(root.cwiseInverse().asDiagonal() * a *
                                                             root.cwiseInverse().asDiagonal());
  const Vector shares = (1.0 - least / parts.eigenvalues().array().max(1e-300)).max(0.0).sqrt();
  return root.asDiagonal() * parts.eigenvectors() * shares.asDiagonal() *
         parts.eigenvectors().transpose() * root.cwiseInverse().asDiagonal();
}

// (I + A B^-1 A)^-1, with A + I = L L^T, A = L a L^T, B = L b L^T: (I + L a b^-1 a L^T)^-1.
Curved curved(Problem& problem, Search& search) {
  const StudentErrors& noise = problem.of().noise;
  const Point& at = search.at;
  const RowMatrix slopes = problem.central_slopes(search);
  const Vector curvatures = noise.curvatures(at.errors, at.scales);
  // Errors far out say little, also where simulations are sensitive.
  RowMatrix weights = noise.weights(at.errors, at.scales);
  const Vector means = weights.colwise().mean().transpose();
  weights *= curvatures.cwiseQuotient(means).asDiagonal();
  const RowMatrix a = problem.curvature(slopes, weights, at.scales);
  RowMatrix with_prior = a;
  with_prior.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> root(with_prior);
  const RowMatrix white =
      root.matrixL().solve(scores_of_steps(noise, at, slopes).transpose()).transpose();
  const Index rollouts = problem.of().num_rollouts;
  RowMatrix b = long_run_covariance(white, rollouts, num_lags(white, rollouts));
  const RowMatrix a_white = root.matrixL().solve(root.matrixL().solve(a).transpose());
  Curved found;
  found.power = std::min(1.0, a_white.trace() / std::max(b.trace(), 1e-12));
  b.diagonal().array() += 1e-9 * std::max(1.0, b.diagonal().maxCoeff());
  const RowMatrix half = kept_by(a, curvature_of_rounding(problem, search, curvatures)) *
                         Eigen::MatrixXd(root.matrixL()) * a_white;
  RowMatrix precision = half * b.ldlt().solve(half.transpose());
  precision.diagonal().array() += 1.0;
  constexpr double most = 1e14;  // of a precision: its inverse can still be factored
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(precision);
  const Vector variances = parts.eigenvalues().cwiseMax(1.0).cwiseMin(most).cwiseInverse();
  found.minimum = {
      at.u, at.cost, at.scales,
      parts.eigenvectors() * variances.asDiagonal() * parts.eigenvectors().transpose()};
  return found;
}

// Shares of a mixture.
void weigh(std::vector<Curved>& all) {
  const double power = all.front().power, least = all.front().minimum.cost;
  double sum = 0.0;
  for (auto& [minimum, unused] : all) {
    const double prior = 0.5 * minimum.u.squaredNorm();
    const Eigen::LLT<Eigen::MatrixXd> root(minimum.covariance);
    const double log_volume = Eigen::MatrixXd(root.matrixL()).diagonal().array().log().sum();
    minimum.weight = -power * (minimum.cost - least - prior) - prior + log_volume;
  }
  double largest = -kInfinity;
  for (const auto& [minimum, unused] : all) largest = std::max(largest, minimum.weight);
  for (auto& [minimum, unused] : all) {
    minimum.weight = std::exp(minimum.weight - largest);
    sum += minimum.weight;
  }
  for (auto& [minimum, unused] : all) minimum.weight /= sum;
  const auto is_light = [](const Curved& each) { return each.minimum.weight < kLeastWeight; };
  all.erase(std::remove_if(all.begin() + 1, all.end(), is_light), all.end());
}

// The `count` rows of u with the smallest costs; fewer where fewer can be simulated.
RowMatrix best_rows(Problem& problem, const RowMatrix& u, Index count) {
  const StudentErrors& noise = problem.of().noise;
  std::vector<Index> rows;
  Vector costs(u.rows());
  problem.for_each(u, [&](Index i, const RowMatrix& errors) {
    if (errors.size() == 0) return;
    costs(i) = noise.cost(errors, noise.scales(errors)) + 0.5 * u.row(i).squaredNorm();
    rows.push_back(i);
  });
  std::ranges::stable_sort(rows, {}, [&](Index i) { return costs(i); });
  rows.resize(std::min(rows.size(), static_cast<std::size_t>(count)));
  return u(rows, Eigen::all);
}

// From each start to its minimum, the best first.
std::vector<Search> descend(Problem& problem, const RowMatrix& starts, Index max_steps) {
  std::vector<Search> searches;
  for (Point& point : problem.points(starts, [](Index) { return Vector(); })) {
    if (point.cost == kInfinity) continue;
    searches.push_back({std::move(point), {}, {}, Vector::Constant(starts.cols(), kFirstMove)});
  }
  for (Index i = 0; i < max_steps && problem.may_go_on(); ++i) {
    merge(searches);
    if (i > 0 && i <= 2 * kStepsBeforeHalving && i % kStepsBeforeHalving == 0) {
      const std::size_t half = (searches.size() + 1) / 2;
      searches.resize(std::min(searches.size(), std::max(half, kFewestStarts)));
    }
    std::vector<Search*> moving = active(searches);
    if (moving.empty()) break;
    differentiate(problem, moving);
    for (Search* search : moving) search->is_done = promised(*search) < kConverged;
    std::erase_if(moving, [](const Search* search) { return search->is_done; });
    advance(problem, moving);
  }
  merge(searches);
  return searches;
}

// With covariances and weights.
std::vector<Minimum> minima_of(Problem& problem, std::vector<Search> searches) {
  std::vector<Curved> all;
  for (Search& search : searches) all.push_back(curved(problem, search));
  if (!all.empty()) weigh(all);
  std::vector<Minimum> minima;
  for (Curved& each : all) minima.push_back(std::move(each.minimum));
  return minima;
}

RowMatrix stacked(const RowMatrix& a, const RowMatrix& b) {
  RowMatrix both(a.rows() + b.rows(), a.cols());
  both << a, b;
  return both;
}

}  // namespace

LeastSquaresFit least_squares(const LeastSquaresProblem& of, const RowMatrix& candidates,
                              const RowMatrix& starts, const LeastSquaresConfig& config,
                              Index max_rounds, const StreamId& id) {
  constexpr double better = 1.0, twice_as_wide = 4.0;
  Problem problem(of, config.max_simulations);
  LeastSquaresFit fit;
  const RowMatrix first = best_rows(problem, candidates, config.num_starts);
  std::vector<Search> searches = descend(problem, stacked(first, starts), config.max_steps);
  if (max_rounds > 0) {
    fit.minima = minima_of(problem, std::move(searches));
  } else {
    for (const Search& each : searches) {
      fit.minima.push_back({each.at.u, each.at.cost, each.at.scales, {}});
    }
  }
  for (Index round = 1; round < max_rounds && !fit.minima.empty() && problem.may_go_on(); ++round) {
    const double before = fit.minima.front().cost;
    LeastSquaresFit wider = fit;
    for (Minimum& minimum : wider.minima) minimum.covariance *= twice_as_wide;
    StreamId of_round = within(id, "least_squares_round");
    of_round.epoch = static_cast<std::uint64_t>(round);
    const RowMatrix near =
        best_rows(problem, wider.sample(candidates.rows(), of_round), config.num_starts);
    std::vector<Minimum> next =
        minima_of(problem, descend(problem, stacked(near, minima_of(fit)), config.max_steps));
    if (next.empty() || next.front().cost > before)
      break;  // as of a simulator that draws at random
    fit.minima = std::move(next);
    if (fit.minima.front().cost > before - better) break;
  }
  fit.num_rows = problem.num_rows;
  fit.num_failed = problem.num_failed;
  fit.converged = problem.may_go_on();
  return fit;
}

RowMatrix minima_of(const LeastSquaresFit& fit) {
  if (fit.minima.empty()) return {};
  RowMatrix u(std::ssize(fit.minima), fit.minima.front().u.size());
  for (Index i = 0; i < u.rows(); ++i) {
    u.row(i) = fit.minima[static_cast<std::size_t>(i)].u.transpose();
  }
  return u;
}

RowMatrix LeastSquaresFit::sample(Index n, const StreamId& id) const {
  Vector weights(std::ssize(minima));
  std::vector<Eigen::MatrixXd> roots;
  for (std::size_t m = 0; m < minima.size(); ++m) {
    weights(static_cast<Index>(m)) = minima[m].weight;
    roots.emplace_back(Eigen::LLT<Eigen::MatrixXd>(minima[m].covariance).matrixL());
  }
  const Resampler resampler(weights);
  RowMatrix u(n, minima.front().u.size());
  for (Index i = 0; i < n; ++i) {
    Stream stream(row_after(id, i));
    const auto m = static_cast<std::size_t>(resampler.draw(stream.uniform()));
    Vector normal(u.cols());
    for (double& each : normal) each = stream.normal();
    u.row(i) = (minima[m].u + roots[m] * normal).transpose();
  }
  return u;
}

}  // namespace npdr::inference
