#include "inference/samplers/slice_sampler.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/constants.h"
#include "core/decompositions.h"
#include "core/error.h"

namespace npdr::inference {
namespace {

constexpr double kFirstWidth = 1.0;  // of an interval, in deviations of the prior
constexpr int kMostSteps = 40;       // of stepping out, to both sides together
constexpr int kMostShrinks = 200;    // an interval of 1e-60 of its width: the density is broken

double finite_or_never(double log_p) { return std::isnan(log_p) ? -kInfinity : log_p; }

// One chain: where it is, and what it is doing along the current direction.
class Chain {
 public:
  Chain(const Vector& u, double log_p, const StreamId& id)
      : stream_(id), u_(u), log_p_(log_p), width_(Vector::Constant(u.size(), kFirstWidth)) {}

  const Vector& u() const { return u_; }
  Index sweeps() const { return sweeps_; }

  // Begins a new stage.
  void begin() {
    interval_sum_.setZero(u_.size());
    start_update();
  }

  void set_widths(const Vector& width) { width_ = width; }
  // Along each direction, of the intervals of this stage.
  const Vector& interval_sum() const { return interval_sum_; }

  // The point that it wants evaluated, along `directions` (D, D), a direction a column.
  void write_point(const Eigen::MatrixXd& directions, Eigen::Ref<Eigen::RowVectorXd> point) const {
    point = (u_ + trial() * directions.col(direction_)).transpose();
  }

  void receive(double log_p, const Eigen::MatrixXd& directions) {
    const bool is_inside = log_p > level_;
    switch (phase_) {
      case Phase::left:
        if (is_inside && steps_left_ > 0) {
          --steps_left_;
          left_ -= width_(direction_);
        } else {
          phase_ = Phase::right;
        }
        return;
      case Phase::right:
        if (is_inside && steps_right_ > 0) {
          --steps_right_;
          right_ += width_(direction_);
        } else {
          begin_shrinking();
        }
        return;
      case Phase::shrink:
        if (is_inside || ++shrinks_ == kMostShrinks) {
          finish_update(is_inside ? log_p : log_p_, is_inside ? offset_ : 0.0, directions);
        } else {
          (offset_ < 0.0 ? left_ : right_) = offset_;
          draw_offset();
        }
        return;
    }
  }

 private:
  enum class Phase { left, right, shrink };

  double trial() const {
    return phase_ == Phase::left ? left_ : phase_ == Phase::right ? right_ : offset_;
  }

  void start_update() {
    const double width = width_(direction_);
    level_ = log_p_ + std::log(stream_.uniform());
    left_ = -width * stream_.uniform();
    right_ = left_ + width;
    phase_ = Phase::left;
    // Shared out at random, so that the limit leaves the chain reversible (Neal 2003, figure 3).
    steps_left_ = static_cast<int>(kMostSteps * stream_.uniform());
    steps_right_ = kMostSteps - 1 - steps_left_;
  }

  void begin_shrinking() {
    phase_ = Phase::shrink;
    shrinks_ = 0;
    draw_offset();
  }

  void draw_offset() { offset_ = left_ + (right_ - left_) * stream_.uniform(); }

  void finish_update(double log_p, double offset, const Eigen::MatrixXd& directions) {
    u_ += offset * directions.col(direction_);
    log_p_ = log_p;
    interval_sum_(direction_) += right_ - left_;
    direction_ = (direction_ + 1) % u_.size();
    if (direction_ == 0) ++sweeps_;
    start_update();
  }

  Stream stream_;
  Vector u_;
  double log_p_;
  Vector width_, interval_sum_;  // (D) along each direction
  Index sweeps_ = 0, direction_ = 0;
  Phase phase_ = Phase::left;
  int steps_left_ = 0, steps_right_ = 0, shrinks_ = 0;
  double level_ = 0.0, left_ = 0.0, right_ = 0.0, offset_ = 0.0;
};

class Population {
 public:
  Population(const LogDensity& log_density, const RowMatrix& start, const StreamId& id)
      : log_density_(log_density),
        directions_(Eigen::MatrixXd::Identity(start.cols(), start.cols())) {
    const Vector log_p = log_density_(start);
    num_points_ += start.rows();
    for (Index c = 0; c < start.rows(); ++c) {
      if (!(log_p(c) > -kInfinity)) {
        throw InputError("slice sampler: chain " + std::to_string(c) +
                         " would begin where the density is 0; choose another start");
      }
      StreamId chain = id;
      chain.row += static_cast<std::uint64_t>(c);
      chains_.emplace_back(start.row(c).transpose(), log_p(c), chain);
    }
  }

  void warm_up(Index num_sweeps) {
    const Index half = num_sweeps / 2;
    run(half);
    turn();
    run(num_sweeps - half);
    if (num_sweeps > half) set_mean_widths(num_sweeps - half);
  }

  // `visit(c, sweep, u)` after each of the next sweeps of each chain, counted from 1.
  void run(Index num_sweeps, const std::function<void(Index, Index, const Vector&)>& visit = {}) {
    std::vector<Index> active(chains_.size()), first;
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      active[c] = static_cast<Index>(c);
      first.push_back(chains_[c].sweeps());
      chains_[c].begin();
    }
    if (num_sweeps == 0) return;
    RowMatrix points;
    while (!active.empty()) {
      points.resize(static_cast<Index>(active.size()), directions_.cols());
      for (std::size_t i = 0; i < active.size(); ++i) {
        chain(active[i]).write_point(directions_, points.row(static_cast<Index>(i)));
      }
      const Vector log_p = log_density_(points);
      num_points_ += points.rows();
      std::vector<Index> still_active;
      for (std::size_t i = 0; i < active.size(); ++i) {
        const Index c = active[i];
        const Index before = chain(c).sweeps();
        chain(c).receive(finite_or_never(log_p(static_cast<Index>(i))), directions_);
        const Index done = chain(c).sweeps() - first[static_cast<std::size_t>(c)];
        if (chain(c).sweeps() > before && visit) visit(c, done, chain(c).u());
        if (done < num_sweeps) still_active.push_back(c);
      }
      active.swap(still_active);
    }
  }

  Index num_points() const { return num_points_; }

 private:
  Chain& chain(Index c) { return chains_[static_cast<std::size_t>(c)]; }

  void set_mean_widths(Index num_sweeps) {
    Vector mean = Vector::Zero(directions_.cols());
    for (const Chain& c : chains_) mean += c.interval_sum();
    mean /= static_cast<double>(num_sweeps) * static_cast<double>(chains_.size());
    for (Chain& c : chains_) c.set_widths(mean);
  }

  // Directions along the principal axes of where the chains are, as long as their deviations.
  void turn() {
    const auto count = static_cast<double>(chains_.size());
    const Index d = directions_.cols();
    if (chains_.size() < 2 * static_cast<std::size_t>(d)) return;
    Vector mean = Vector::Zero(d);
    for (const Chain& c : chains_) mean += c.u() / count;
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(d, d);
    for (const Chain& c : chains_) {
      covariance += (c.u() - mean) * (c.u() - mean).transpose() / count;
    }
    const SymmetricEigen axes(covariance);
    const double largest = axes.values.maxCoeff();
    if (!axes.has_converged || !(largest > 0.0)) return;
    const Vector deviations = axes.values.cwiseMax(1e-12 * largest).cwiseSqrt();
    directions_ = axes.vectors * deviations.asDiagonal();
    for (Chain& c : chains_) c.set_widths(Vector::Constant(d, kFirstWidth));
  }

  const LogDensity& log_density_;
  Eigen::MatrixXd directions_;
  std::vector<Chain> chains_;
  Index num_points_ = 0;
};

}  // namespace

ChainDraws slice_sample(const LogDensity& log_density, const RowMatrix& start, Index num_draws,
                        const SliceSamplerConfig& config, const StreamId& id) {
  if (config.thin < 1 || config.num_warmup < 0) {
    throw InputError("slice sampler: thin = " + std::to_string(config.thin) + ", num_warmup = " +
                     std::to_string(config.num_warmup) + ", must be >= 1 and >= 0");
  }
  Population population(log_density, start, id);
  population.warm_up(config.num_warmup);
  ChainDraws draws{RowMatrix(num_draws * start.rows(), start.cols()), start.rows(), 0};
  population.run(num_draws * config.thin, [&](Index c, Index sweep, const Vector& u) {
    if (sweep % config.thin != 0) return;
    draws.u.row((sweep / config.thin - 1) * start.rows() + c) = u.transpose();
  });
  draws.num_points = population.num_points();
  return draws;
}

}  // namespace npdr::inference
