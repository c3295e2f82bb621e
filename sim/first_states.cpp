#include "sim/first_states.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/decompositions.h"
#include "core/error.h"

namespace npdr::sim {
namespace {

Index segments_of_rollout(const NoiseModel& model) {
  return std::ranges::count_if(model.restarts(), [](char is) { return is != 0; });
}

// Calls visit(k, s, now, before) for the stored states of channel c in rollout h, s the segment of
// the rollout that state k is of, with v_k and v_{k-1}.
class ErrorSeries {
 public:
  ErrorSeries(const NoiseModel& model, std::span<const float> recorded,
              std::span<const float> simulated, const FirstStates& first)
      : model_(model),
        recorded_(recorded),
        simulated_(simulated),
        first_(first),
        per_rollout_(segments_of_rollout(model)) {}

  template <class Visit>
  void visit(Index h, Index c, Visit&& visit) const {
    const Index channels = model_.num_states(), rollouts = model_.num_rollouts();
    Vector now(1 + channels), before(1 + channels);
    Index segment = -1;
    for (Index k = 0; k < model_.num_steps(); ++k) {
      if (model_.restarts()[static_cast<std::size_t>(k)] != 0) {
        ++segment;
        before.setZero();
        before(0) = first_.errors(h * per_rollout_ + segment, c);
        before(1 + c) = 1.0;
      }
      const double unit = model_.unit()(h, c), base = value(simulated_, h, k, c);
      now(0) = (value(recorded_, h, k, c) - base) / unit;
      for (Index m = 0; m < channels; ++m) {
        const double change = value(simulated_, (1 + m) * rollouts + h, k, c) - base;
        now(1 + m) = change / unit * (model_.unit()(h, m) / first_.moves(h, m));
      }
      visit(k, segment, now, before);
      before = now;
    }
  }

 private:
  double value(std::span<const float> series, Index h, Index k, Index c) const {
    const Index i = (h * model_.num_steps() + k) * model_.num_states() + c;
    return static_cast<double>(series[static_cast<std::size_t>(i)]);
  }

  const NoiseModel& model_;
  std::span<const float> recorded_, simulated_;
  const FirstStates& first_;
  Index per_rollout_;
};

}  // namespace

RowMatrix first_state_moves(const NoiseModel& model) {
  const RowMatrix size = model.relative_size().array().max(0x1p-13).min(0x1p-9);
  return size.cwiseProduct(model.measure());
}

FirstStates recorded_first_states(const NoiseModel& model) {
  const Index num_segments = model.num_rollouts() * segments_of_rollout(model);
  return {first_state_moves(model), RowMatrix::Zero(num_segments, model.num_states())};
}

Target begun_at(const FirstStates& first, const NoiseModel& model, const Target& target,
                Index segment_length) {
  Target result = target;
  const Index per_rollout = segments_of_rollout(model);
  for (Index h = 0; h < target.num_rollouts(); ++h) {
    RowMatrix& states = result.rollouts[static_cast<std::size_t>(h)].states;
    for (Index s = 0; s < per_rollout; ++s) {
      states.row(s * segment_length) -=
          first.errors.row(h * per_rollout + s).cwiseProduct(model.unit().row(h));
    }
  }
  for (Index c = 0; c < target.num_states(); ++c) {
    for (Index h = 0; h < target.num_rollouts(); ++h) {
      Rollout moved = result.rollouts[static_cast<std::size_t>(h)];
      moved.states.col(c).array() += first.moves(h, c);
      result.rollouts.push_back(std::move(moved));
    }
  }
  return result;
}

FirstStateErrors::FirstStateErrors(const NoiseModel& model, std::span<const float> recorded,
                                   std::span<const float> simulated, const FirstStates& first,
                                   Index left_out)
    : num_channels_(model.num_states()),
      num_states_(Vector::Zero(model.num_states())),
      rounding_(model.num_states()) {
  const Index channels = num_channels_;
  if (std::ssize(simulated) != (1 + channels) * std::ssize(recorded)) {
    throw ShapeError("first states: simulations don't have a rollout for each channel's moves");
  }
  for (Index c = 0; c < channels; ++c) {
    const bool is_in_unit = model.channels()[static_cast<std::size_t>(c)].is_in_unit;
    rounding_(c) = is_in_unit ? 0.0 : kStateRounding * kStateRounding;
  }
  const ErrorSeries series(model, recorded, simulated, first);
  const Index per_rollout = segments_of_rollout(model);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(1 + channels, 1 + channels);
  for (Index h = 0; h < model.num_rollouts(); ++h) {
    if (h == left_out) continue;
    const Index num_before = num_segments();
    sums_.resize(static_cast<std::size_t>((num_before + per_rollout) * channels),
                 {none, none, none});
    begun_.conservativeResize(num_before + per_rollout, channels);
    begun_.bottomRows(per_rollout) = first.errors.middleRows(h * per_rollout, per_rollout);
    for (Index c = 0; c < channels; ++c) {
      const auto steps = static_cast<double>(model.num_steps());
      log_measure_ += steps * std::log(model.measure()(h, c) / model.unit()(h, c));
      num_states_(c) += steps;
      series.visit(h, c, [&](Index, Index segment, const Vector& now, const Vector& before) {
        sums_[static_cast<std::size_t>((num_before + segment) * channels + c)].add(now, before);
      });
    }
  }
}

bool FirstStateErrors::are_finite() const {
  return std::ranges::all_of(sums_, [](const Sums& sums) { return sums.now.allFinite(); });
}

FirstStateErrors::Gaussian FirstStateErrors::gaussian(Index segment,
                                                      const std::vector<NoiseValues>& values,
                                                      double* squares) const {
  const Index channels = num_channels_;
  Gaussian result{Eigen::MatrixXd::Zero(channels, channels), Vector::Zero(channels)};
  for (Index c = 0; c < channels; ++c) {
    const NoiseValues& at = values[static_cast<std::size_t>(c)];
    const double weight = 1.0 / (at.scale * at.scale);
    const Eigen::MatrixXd whitened = sums(segment, c).whitened(at.correlation);
    const double prior = weight * (1.0 - at.correlation * at.correlation);
    const double begun = begun_(segment, c);
    result.precision += weight * whitened.bottomRightCorner(channels, channels);
    result.precision(c, c) += prior;
    result.shift -= weight * whitened.col(0).tail(channels);
    result.shift(c) -= prior * begun;
    if (squares != nullptr) *squares += weight * whitened(0, 0) + prior * begun * begun;
  }
  return result;
}

double FirstStateErrors::log_density(const std::vector<NoiseValues>& values) const {
  double sum = log_measure_, squares = 0.0;
  for (Index c = 0; c < num_channels_; ++c) {
    const NoiseValues& at = values[static_cast<std::size_t>(c)];
    sum -= num_states_(c) * (std::log(at.scale) + 0.5 * kLogTwoPi);
    squares += num_states_(c) * rounding_(c) / (at.scale * at.scale);
    sum += static_cast<double>(num_segments()) *
           (0.5 * std::log(1.0 - at.correlation * at.correlation) - std::log(at.scale));
  }
  for (Index s = 0; s < num_segments(); ++s) {
    const Gaussian first = gaussian(s, values, &squares);
    const Cholesky factor(first.precision);
    if (!factor.is_positive_definite()) return kNaN;
    const Vector half = factor.solve_lower(first.shift);
    sum += 0.5 * half.squaredNorm() - factor.half_log_det();
  }
  return sum - 0.5 * squares;
}

Vector FirstStateErrors::size() const {
  Vector squares = Vector::Zero(num_channels_);
  for (Index s = 0; s < num_segments(); ++s) {
    for (Index c = 0; c < num_channels_; ++c) squares(c) += sums(s, c).now(0, 0);
  }
  return (squares.array() / num_states_.array()).sqrt().max(kStateRounding);
}

Vector FirstStateErrors::correlation() const {
  Vector product = Vector::Zero(num_channels_), before = product;
  for (Index s = 0; s < num_segments(); ++s) {
    for (Index c = 0; c < num_channels_; ++c) {
      product(c) += 0.5 * sums(s, c).product(0, 0);
      before(c) += sums(s, c).before(0, 0);
    }
  }
  return (before.array() > 0.0).select(product.array() / before.array(), 0.0);
}

RowMatrix FirstStateErrors::first_errors(const std::vector<NoiseValues>& values) const {
  RowMatrix errors(num_segments(), num_channels_);
  for (Index s = 0; s < num_segments(); ++s) {
    const Gaussian first = gaussian(s, values, nullptr);
    errors.row(s) = begun_.row(s) + Cholesky(first.precision).solve(first.shift).transpose();
  }
  return errors;
}

std::vector<float> from_first_states(const NoiseModel& model, std::span<const float> simulated,
                                     const FirstStates& first, const RowMatrix& errors) {
  const auto size =
      static_cast<std::size_t>(model.num_rollouts() * model.num_steps() * model.num_states());
  std::vector<float> result(simulated.begin(),
                            simulated.begin() + static_cast<std::ptrdiff_t>(size));
  const ErrorSeries series(model, simulated, simulated, first);
  const RowMatrix more = errors - first.errors;
  const Index per_rollout = segments_of_rollout(model);
  for (Index h = 0; h < model.num_rollouts(); ++h) {
    for (Index c = 0; c < model.num_states(); ++c) {
      series.visit(h, c, [&](Index k, Index segment, const Vector& now, const Vector&) {
        const double change = -more.row(h * per_rollout + segment).dot(now.tail(now.size() - 1));
        result[static_cast<std::size_t>((h * model.num_steps() + k) * model.num_states() + c)] +=
            static_cast<float>(model.unit()(h, c) * change);
      });
    }
  }
  return result;
}

}  // namespace npdr::sim
