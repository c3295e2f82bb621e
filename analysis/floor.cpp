#include "analysis/floor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <nlopt.hpp>
#include <vector>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

void check(const FloorConfig& config) {
  const auto require = [](bool holds, const char* name, auto value, const char* allowed) {
    if (!holds) throw InputError(fmt::format("floor: {} = {}, must be {}", name, value, allowed));
  };
  require(config.num_restarts >= 1, "num_restarts", config.num_restarts, ">= 1");
  require(config.max_local_evaluations >= 1, "max_local_evaluations", config.max_local_evaluations,
          ">= 1");
  require(config.local_step > 0.0 && config.local_step <= 0.5, "local_step", config.local_step,
          "in (0, 0.5]");
  require(config.local_tolerance > 0.0, "local_tolerance", config.local_tolerance, "> 0");
}

// The prior's box and the map from the unit cube, where the searches live, to it.
struct Bounds {
  const Vector& lower;
  const Vector& upper;

  // Exact at 0 and 1, so that a minimum on the border is reported on the border.
  RowMatrix to_theta(const RowMatrix& unit) const {
    RowMatrix theta(unit.rows(), unit.cols());
    for (Index i = 0; i < unit.rows(); ++i) {
      for (Index d = 0; d < unit.cols(); ++d) {
        const double inside = lower(d) + unit(i, d) * (upper(d) - lower(d));
        theta(i, d) = unit(i, d) >= 1.0 ? upper(d) : std::min(inside, upper(d));
      }
    }
    return theta;
  }

  RowMatrix to_unit(const RowMatrix& theta) const {
    RowMatrix unit(theta.rows(), theta.cols());
    for (Index d = 0; d < theta.cols(); ++d) {
      unit.col(d) = (theta.col(d).array() - lower(d)) / (upper(d) - lower(d));
    }
    return unit;
  }

  void check(const RowMatrix& starting_points) const {
    if (lower.size() < 1 || lower.size() != upper.size()) {
      throw ShapeError(
          fmt::format("floor: box has {} lower and {} upper bounds", lower.size(), upper.size()));
    }
    for (Index d = 0; d < lower.size(); ++d) {
      if (std::isfinite(upper(d) - lower(d)) && lower(d) < upper(d)) continue;
      throw InputError(
          fmt::format("floor: bounds [{}, {}] of parameter {}, must be finite and "
                      "ascending",
                      lower(d), upper(d), d));
    }
    if (starting_points.rows() == 0) return;
    if (starting_points.cols() != lower.size()) {
      throw ShapeError(fmt::format("floor: starting points have {} parameters, the box {}",
                                   starting_points.cols(), lower.size()));
    }
    for (Index i = 0; i < starting_points.rows(); ++i) {
      for (Index d = 0; d < lower.size(); ++d) {
        const double value = starting_points(i, d);
        if (value >= lower(d) && value <= upper(d)) continue;
        throw InputError(
            fmt::format("floor: starting point {} has parameter {} = {}, must be in "
                        "[{}, {}]",
                        i, d, value, lower(d), upper(d)));
      }
    }
  }
};

// A local search from the best point of a global one.
class LocalSearch {
 public:
  LocalSearch(const BatchObjective& objective, const DifferentialEvolutionResult& found)
      : objective_(objective), best_(found.points.row(0)), best_value_(found.values(0)) {
    // NLopt fits models through all values, so points of no use get the worst usable value, which
    // repels just as well.
    for (const double v : found.values) {
      if (std::isfinite(v)) penalty_ = v;
    }
  }

  void run(nlopt::algorithm algorithm, const FloorConfig& config) {
    const auto dimension = static_cast<unsigned>(best_.size());
    nlopt::opt search(algorithm, dimension);
    search.set_lower_bounds(0.0);
    search.set_upper_bounds(1.0);
    search.set_initial_step(config.local_step);
    search.set_xtol_abs(config.local_tolerance);
    search.set_maxeval(static_cast<int>(config.max_local_evaluations));
    search.set_min_objective(&LocalSearch::call, this);
    std::vector<double> point(best_.data(), best_.data() + best_.size());
    double value = best_value_;
    try {
      search.optimize(point, value);
    } catch (const nlopt::roundoff_limited&) {
      // As far as this precision goes; the best point so far is kept below.
    } catch (const nlopt::forced_stop&) {
      std::rethrow_exception(failure_);
    }
  }

  const Eigen::RowVectorXd& best() const { return best_; }
  double best_value() const { return best_value_; }
  Index num_evaluations() const { return num_evaluations_; }

 private:
  // NLopt would lose the exception's type and message; it is kept and rethrown by run().
  static double call(unsigned dimension, const double* point, double*, void* self) {
    auto& search = *static_cast<LocalSearch*>(self);
    try {
      return search.evaluate(Eigen::Map<const Eigen::RowVectorXd>(point, dimension));
    } catch (...) {
      search.failure_ = std::current_exception();
      throw nlopt::forced_stop();
    }
  }

  double evaluate(const Eigen::RowVectorXd& point) {
    const double value = objective_(point)(0);
    ++num_evaluations_;
    if (!std::isfinite(value)) return penalty_;
    if (value < best_value_) {
      best_value_ = value;
      best_ = point;
    }
    return value;
  }

  const BatchObjective& objective_;
  Eigen::RowVectorXd best_;
  double best_value_;
  double penalty_ = 0.0;
  Index num_evaluations_ = 0;
  std::exception_ptr failure_;
};

DifferentialEvolutionConfig global_config(const FloorConfig& config, Index restart) {
  return {config.population, config.max_generations, config.global_tolerance, config.seed,
          static_cast<std::uint64_t>(restart)};
}

}  // namespace

FloorResult find_floor(const BatchObjective& objective, const Vector& lower, const Vector& upper,
                       const RowMatrix& starting_points, const FloorConfig& config) {
  check(config);
  const Bounds box{lower, upper};
  box.check(starting_points);
  const BatchObjective in_unit_cube = [&](const RowMatrix& unit) {
    return objective(box.to_theta(unit));
  };
  FloorResult result;
  result.value = kInfinity;
  result.restart_values = Vector::Constant(config.num_restarts, result.value);
  for (Index r = 0; r < config.num_restarts; ++r) {
    const RowMatrix start = r == 0 ? box.to_unit(starting_points) : RowMatrix();
    const auto found =
        differential_evolution(in_unit_cube, lower.size(), start, global_config(config, r));
    result.num_evaluations += found.num_evaluations;
    if (!std::isfinite(found.values(0))) continue;
    LocalSearch local(in_unit_cube, found);
    local.run(nlopt::LN_BOBYQA, config);
    local.run(nlopt::LN_SBPLX, config);
    result.num_evaluations += local.num_evaluations();
    result.restart_values(r) = local.best_value();
    if (local.best_value() >= result.value) continue;
    result.value = local.best_value();
    result.theta = box.to_theta(local.best()).row(0).transpose();
  }
  if (!std::isfinite(result.value)) {
    throw Error(fmt::format("floor: the objective is finite at none of {} points of the box",
                            result.num_evaluations));
  }
  return result;
}

}  // namespace npdr::analysis
