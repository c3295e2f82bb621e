#include "analysis/recording_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace npdr::analysis {
namespace {

RowMatrix stored_states(const Target& target, Index store_every) {
  const Index steps = target.num_steps() / store_every;
  RowMatrix states(target.num_rollouts() * steps, target.num_states());
  for (Index i = 0; i < states.rows(); ++i) {
    const Rollout& rollout = target.rollouts[static_cast<std::size_t>(i / steps)];
    states.row(i) = rollout.states.row((i % steps + 1) * store_every);
  }
  return states;
}

// A step of a fit.
struct Step {
  Vector theta;            // (D), in widths of the box
  RowMatrix first_states;  // (segments of all rollouts, C)
  RowMatrix errors;        // (H K, C) that it would leave were simulations linear
};

class Fitter {
 public:
  Fitter(const FitProblem& problem, const Target& recording, Index segment_length)
      : problem_(problem),
        recording_(recording),
        width_(problem.upper - problem.lower),
        states_(stored_states(recording, problem.store_every)),
        steps_(states_.rows() / recording.num_rollouts()),
        length_(segment_length),
        segments_((recording.num_steps() + length_ - 1) / length_) {}

  // From theta, and the first states of a fit in shorter segments.
  Fit begin(const Fit& from) const {
    Fit fit{{}, from.theta, {}, length_};
    fit.first_states.setZero(recording_.num_rollouts() * segments_, states_.cols());
    if (from.first_states.size() == 0) return with_errors(fit);
    const Index per_rollout = from.first_states.rows() / recording_.num_rollouts();
    for (Index i = 0; i < fit.first_states.rows(); ++i) {
      const Index start = i % segments_ * length_;
      if (start % from.segment_length != 0) continue;
      fit.first_states.row(i) =
          from.first_states.row(i / segments_ * per_rollout + start / from.segment_length);
    }
    return with_errors(fit);
  }

  Fit with_errors(Fit fit) const {
    const RowMatrix found = errors_of(begun_at(fit.first_states), fit.theta.transpose());
    fit.errors = found.allFinite() ? shaped(found.row(0)) : RowMatrix();
    return fit;
  }

  // Whether it converges.
  bool improve(Fit& fit) const {
    constexpr int num_steps = 20, num_halvings = 5;
    constexpr double converged = 0.97;
    for (int i = 0; i < num_steps && fit.errors.size() > 0; ++i) {
      const Step step = step_from(fit);
      const double before = loss(fit);
      if (step.errors.squaredNorm() >= 0.98 * fit.errors.squaredNorm()) return true;
      bool helps = false;
      for (int k = 0; k < num_halvings && !helps; ++k) {
        const double share = std::pow(0.5, k);
        const Vector theta = fit.theta + share * step.theta.cwiseProduct(width_);
        Fit tried = fit;
        tried.theta = theta.cwiseMax(problem_.lower).cwiseMin(problem_.upper);
        tried.first_states += share * step.first_states;
        tried = with_errors(tried);
        helps = tried.errors.size() > 0 && loss(tried) < before;
        if (helps) fit = tried;
      }
      if (!helps) return step.errors.norm() > converged * fit.errors.norm();
    }
    return fit.errors.size() > 0 && step_from(fit).errors.norm() > converged * fit.errors.norm();
  }

  // Segments' first states are eliminated: each appears in its own errors only.
  Step step_from(const Fit& at) const {
    const Index dimension = at.theta.size(), channels = states_.cols();
    const RowMatrix slopes = slopes_of(at);                        // (H K C, D + C)
    RowMatrix normal = RowMatrix::Identity(dimension, dimension);  // a prior as wide as the box
    Vector right = Vector::Zero(dimension);
    std::vector<RowMatrix> inner, cross;
    std::vector<Vector> own;
    for_each_segment([&](Index segment, Index begin, Index count) {
      const auto all = slopes.middleRows(begin * channels, count * channels);
      const RowMatrix of_theta = all.leftCols(dimension), of_first = all.rightCols(channels);
      const Vector errors = at.errors.middleRows(begin, count).reshaped<Eigen::RowMajor>();
      const RowMatrix a = of_first.transpose() * of_first + RowMatrix::Identity(channels, channels);
      const RowMatrix b = of_first.transpose() * of_theta;
      const Vector g = of_first.transpose() * errors + at.first_states.row(segment).transpose();
      inner.push_back(a.inverse());
      cross.push_back(b);
      own.push_back(g);
      normal += of_theta.transpose() * of_theta - b.transpose() * inner.back() * b;
      right += of_theta.transpose() * errors - b.transpose() * inner.back() * g;
    });
    Step step{free_step(at.theta, normal, right),
              RowMatrix::Zero(at.first_states.rows(), at.first_states.cols()), at.errors};
    std::size_t next = 0;
    for_each_segment([&](Index segment, Index begin, Index count) {
      const Vector moved = -inner[next] * (own[next] + cross[next] * step.theta);
      step.first_states.row(segment) = moved.transpose();
      Vector both(dimension + channels);
      both << step.theta, moved;
      const Vector change = slopes.middleRows(begin * channels, count * channels) * both;
      step.errors.middleRows(begin, count) += change.reshaped<Eigen::RowMajor>(count, channels);
      ++next;
    });
    return step;
  }

 private:
  static double loss(const Fit& fit) {
    return fit.first_states.squaredNorm() + fit.errors.squaredNorm();
  }

  // Without those on a bound that would leave the box.
  Vector free_step(const Vector& theta, RowMatrix normal, Vector right) const {
    Vector step = -normal.ldlt().solve(right);
    for (Index d = 0; d < theta.size(); ++d) {
      const bool leaves =
          step(d) < 0.0 ? theta(d) <= problem_.lower(d) : theta(d) >= problem_.upper(d);
      if (!leaves) continue;
      normal.row(d).setZero();
      normal.col(d).setZero();
      normal(d, d) = 1.0;
      right(d) = 0.0;
      step = -normal.ldlt().solve(right);
    }
    return step;
  }

  // visit(segment, first of its rows of errors, their number)
  template <class Visit>
  void for_each_segment(const Visit& visit) const {
    for (Index h = 0; h < recording_.num_rollouts(); ++h) {
      for (Index s = 0; s < segments_; ++s) {
        const Index begin = s * length_ / problem_.store_every;
        const Index end = std::min((s + 1) * length_ / problem_.store_every, steps_);
        if (begin < end) visit(h * segments_ + s, h * steps_ + begin, end - begin);
      }
    }
  }

  Target begun_at(const RowMatrix& first_states) const {
    Target target = recording_;
    for (Index i = 0; i < first_states.rows(); ++i) {
      const Index h = i / segments_;
      target.rollouts[static_cast<std::size_t>(h)].states.row(i % segments_ * length_) -=
          first_states.row(i).cwiseProduct(problem_.sigma.row(h));
    }
    return target;
  }

  // Errors (n, H K C) of rows of theta; of rollouts that repeat the recording's, as often as these.
  RowMatrix errors_of(const Target& target, const RowMatrix& theta) const {
    RowMatrix all = problem_.replay(target, length_, theta);
    const Index channels = states_.cols();
    for (Index i = 0; i < all.rows(); ++i) {
      for (Index j = 0; j < all.cols(); ++j) {
        const Index row = j / channels % states_.rows(), c = j % channels;
        all(i, j) = (states_(row, c) - all(i, j)) / problem_.sigma(row / steps_, c);
      }
    }
    return all;
  }

  RowMatrix shaped(const Vector& errors) const {
    return errors.reshaped<Eigen::RowMajor>(states_.rows(), states_.cols());
  }

  // By theta in widths of the box, then by the first state of the segment, (H K C, D + C); 0 where
  // a moved one can't be simulated.
  RowMatrix slopes_of(const Fit& at) const {
    constexpr double move = 1e-3, first_move = 0.05;
    const Index dimension = at.theta.size(), channels = states_.cols();
    const Vector errors = at.errors.reshaped<Eigen::RowMajor>();
    RowMatrix theta = at.theta.transpose().replicate(dimension, 1);
    Vector moves(dimension);
    for (Index d = 0; d < dimension; ++d) {
      const double step = move * width_(d);
      moves(d) = at.theta(d) + step <= problem_.upper(d) ? move : -move;
      theta(d, d) += moves(d) * width_(d);
    }
    RowMatrix slopes(errors.size(), dimension + channels);
    const auto set = [&](Index column, const Vector& moved, double by) {
      slopes.col(column).setZero();
      if (moved.allFinite()) slopes.col(column) = (moved - errors) / by;
    };
    const RowMatrix moved = errors_of(begun_at(at.first_states), theta);
    for (Index d = 0; d < dimension; ++d) set(d, moved.row(d).transpose(), moves(d));
    Target all;
    for (Index c = 0; c < channels; ++c) {
      RowMatrix first = at.first_states;
      first.col(c).array() += first_move;
      const Target target = begun_at(first);
      if (c == 0)
        all = target;
      else
        all.rollouts.insert(all.rollouts.end(), target.rollouts.begin(), target.rollouts.end());
    }
    const RowMatrix begun = errors_of(all, at.theta.transpose());
    for (Index c = 0; c < channels; ++c) {
      set(dimension + c, begun.row(0).segment(c * errors.size(), errors.size()).transpose(),
          first_move);
    }
    return slopes;
  }

  const FitProblem& problem_;
  const Target& recording_;
  Vector width_;
  RowMatrix states_;  // (H K, C)
  Index steps_, length_, segments_;
};

}  // namespace

Index first_length(const FitProblem& problem, const Target& recording) {
  const Index part = problem.parts * problem.store_every;
  const Index length = (recording.num_steps() + part - 1) / part * problem.store_every;
  return problem.segment_length > 0 ? std::min(problem.segment_length, length) : length;
}

Fit fit(const FitProblem& problem, const Target& recording, const Vector& theta) {
  const Index steps = recording.num_steps();
  const Index longest =
      problem.segment_length > 0 ? std::min(problem.segment_length, steps) : steps;
  Fit found{{}, theta, {}};
  for (Index length = first_length(problem, recording);; length *= 2) {
    length = std::min(length, longest);
    const Fitter fitter(problem, recording, length);
    Fit next = fitter.begin(found);
    const bool converges = fitter.improve(next);
    if (!converges && found.errors.size() > 0) break;
    found = next;
    if (length == longest) break;
  }
  return found;
}

RowMatrix errors_after_step(const FitProblem& problem, const Target& recording, const Fit& start) {
  const Fitter fitter(problem, recording, start.segment_length);
  const Fit at = fitter.with_errors(start);
  return at.errors.size() > 0 ? fitter.step_from(at).errors : RowMatrix();
}

}  // namespace npdr::analysis
