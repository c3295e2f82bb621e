#include "analysis/differential_evolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

// Constants of Zhang and Sanderson (2009), section III.
constexpr double kGreediness = 0.1;    // p: the share of the population that counts as best
constexpr double kLearningRate = 0.1;  // c: of the means of F and CR
constexpr double kSpread = 0.1;        // of F and CR around their means

void check(const DifferentialEvolutionConfig& config) {
  if (config.population < 4) {
    throw InputError(fmt::format("floor: population = {}, must be >= 4", config.population));
  }
  if (config.max_generations < 0) {
    throw InputError(
        fmt::format("floor: max_generations = {}, must be >= 0", config.max_generations));
  }
  if (!(config.tolerance >= 0.0)) {
    throw InputError(fmt::format("floor: tolerance = {}, must be >= 0", config.tolerance));
  }
}

// Attempt of one member of the population.
struct Trial {
  double scale = 0.0;      // F
  double crossover = 0.0;  // CR
};

class Search {
 public:
  Search(const BatchObjective& objective, Index dimension,
         const DifferentialEvolutionConfig& config)
      : objective_(objective), config_(config), dimension_(dimension) {}

  DifferentialEvolutionResult run(const RowMatrix& start) {
    points_ = first_population(start);
    values_ = evaluate(points_);
    for (Index g = 1; g <= config_.max_generations && !converged(); ++g) advance(g);
    return sorted();
  }

 private:
  Stream stream(Index row, Index generation) const {
    return Stream({config_.seed, "differential_evolution", config_.restart,
                   static_cast<std::uint64_t>(row), static_cast<std::uint64_t>(generation)});
  }

  // One point in each of `population` slices of every coordinate.
  RowMatrix first_population(const RowMatrix& start) const {
    const Index n = config_.population;
    RowMatrix points(n, dimension_);
    Stream random = stream(0, 0);
    for (Index d = 0; d < dimension_; ++d) {
      const auto slices = random.permutation(static_cast<std::uint32_t>(n));
      for (Index i = 0; i < n; ++i) {
        points(i, d) =
            (slices[static_cast<std::size_t>(i)] + random.uniform()) / static_cast<double>(n);
      }
    }
    const Index given = std::min(n, start.rows());
    for (Index i = 0; i < given; ++i) points.row(i) = start.row(i);
    return points;
  }

  Vector evaluate(const RowMatrix& points) {
    Vector values = objective_(points);
    if (values.size() != points.rows()) {
      throw ShapeError(fmt::format("floor: the objective returned {} values for {} points",
                                   values.size(), points.rows()));
    }
    num_evaluations_ += points.rows();
    for (double& v : values) {
      if (!std::isfinite(v)) v = kInfinity;
    }
    return values;
  }

  bool converged() const {
    const double best = values_.minCoeff();
    return values_.maxCoeff() - best <= config_.tolerance * std::abs(best);
  }

  // Members of the population from the best to the worst; ties in the order of the members.
  std::vector<Index> ranking() const {
    std::vector<Index> order(static_cast<std::size_t>(values_.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(),
                     [this](Index a, Index b) { return values_(a) < values_(b); });
    return order;
  }

  // F is Cauchy distributed, redrawn when not positive; CR is normal; both are cut at 1.
  Trial draw_trial(Stream& random) const {
    Trial trial;
    while (trial.scale <= 0.0) {
      trial.scale = mean_scale_ + kSpread * std::tan(std::numbers::pi * (random.uniform() - 0.5));
    }
    trial.scale = std::min(trial.scale, 1.0);
    trial.crossover = std::clamp(mean_crossover_ + kSpread * random.normal(), 0.0, 1.0);
    return trial;
  }

  // u_i. r1 and r2 differ from i and from each other; r2 may be a point that was replaced before.
  Eigen::RowVectorXd offspring(Index i, const Trial& trial, const std::vector<Index>& order,
                               Stream& random) const {
    const auto n = static_cast<std::uint32_t>(points_.rows());
    const auto num_best = std::max(2u, static_cast<std::uint32_t>(kGreediness * n));
    const Index best = order[random.below(num_best)];
    Index r1 = i;
    while (r1 == i) r1 = random.below(n);
    Index r2 = i;
    while (r2 == i || r2 == r1) r2 = random.below(n + static_cast<std::uint32_t>(archive_.size()));
    const Eigen::RowVectorXd x = points_.row(i);
    const Eigen::RowVectorXd other =
        r2 < n ? Eigen::RowVectorXd(points_.row(r2)) : archive_[static_cast<std::size_t>(r2 - n)];
    const Eigen::RowVectorXd mutant =
        x + trial.scale * (points_.row(best) - x) + trial.scale * (points_.row(r1) - other);
    const Index always = random.below(static_cast<std::uint32_t>(dimension_));
    Eigen::RowVectorXd result = x;
    for (Index d = 0; d < dimension_; ++d) {
      const bool cross = random.uniform() < trial.crossover;
      if (cross || d == always) result(d) = std::clamp(mutant(d), 0.0, 1.0);
    }
    return result;
  }

  void advance(Index generation) {
    const Index n = points_.rows();
    const std::vector<Index> order = ranking();
    std::vector<Trial> trials(static_cast<std::size_t>(n));
    RowMatrix candidates(n, dimension_);
    for (Index i = 0; i < n; ++i) {
      Stream random = stream(i, generation);
      Trial& trial = trials[static_cast<std::size_t>(i)];
      trial = draw_trial(random);
      candidates.row(i) = offspring(i, trial, order, random);
    }
    const Vector candidate_values = evaluate(candidates);
    std::vector<Trial> successes;
    for (Index i = 0; i < n; ++i) {
      if (!(candidate_values(i) <= values_(i))) continue;
      if (candidate_values(i) < values_(i)) {
        archive_.emplace_back(points_.row(i));
        successes.push_back(trials[static_cast<std::size_t>(i)]);
      }
      points_.row(i) = candidates.row(i);
      values_(i) = candidate_values(i);
    }
    learn(successes);
    trim_archive(generation);
  }

  // The arithmetic mean of what succeeded for CR, the Lehmer mean for F (which favors large
  // steps).
  void learn(const std::vector<Trial>& successes) {
    if (successes.empty()) return;
    double crossover = 0.0, scale = 0.0, scale_squares = 0.0;
    for (const Trial& trial : successes) {
      crossover += trial.crossover;
      scale += trial.scale;
      scale_squares += trial.scale * trial.scale;
    }
    crossover /= static_cast<double>(successes.size());
    mean_crossover_ += kLearningRate * (crossover - mean_crossover_);
    mean_scale_ += kLearningRate * (scale_squares / scale - mean_scale_);
  }

  void trim_archive(Index generation) {
    Stream random = stream(points_.rows(), generation);
    while (archive_.size() > static_cast<std::size_t>(points_.rows())) {
      std::swap(archive_[random.below(static_cast<std::uint32_t>(archive_.size()))],
                archive_.back());
      archive_.pop_back();
    }
  }

  DifferentialEvolutionResult sorted() const {
    DifferentialEvolutionResult result;
    result.points.resize(points_.rows(), dimension_);
    result.values.resize(values_.size());
    result.num_evaluations = num_evaluations_;
    Index row = 0;
    for (const Index i : ranking()) {
      result.points.row(row) = points_.row(i);
      result.values(row++) = values_(i);
    }
    return result;
  }

  const BatchObjective& objective_;
  const DifferentialEvolutionConfig& config_;
  Index dimension_;
  RowMatrix points_;  // (population, D)
  Vector values_;     // (population)
  std::vector<Eigen::RowVectorXd> archive_;
  double mean_scale_ = 0.5;
  double mean_crossover_ = 0.5;
  Index num_evaluations_ = 0;
};

}  // namespace

DifferentialEvolutionResult differential_evolution(const BatchObjective& objective, Index dimension,
                                                   const RowMatrix& start,
                                                   const DifferentialEvolutionConfig& config) {
  check(config);
  if (dimension < 1 || (start.rows() > 0 && start.cols() != dimension)) {
    throw ShapeError(fmt::format("floor: starting points have shape ({}, {}), must be (k, {})",
                                 start.rows(), start.cols(), dimension));
  }
  return Search(objective, dimension, config).run(start);
}

}  // namespace npdr::analysis
