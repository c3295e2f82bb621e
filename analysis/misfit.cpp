#include "analysis/misfit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

RowMatrix sizes_by_part(const RowMatrix& errors, Index num_rollouts) {
  const Index steps = errors.rows() / num_rollouts, parts = std::min(kMisfitParts, steps);
  RowMatrix sizes(num_rollouts * parts, errors.cols());
  for (Index h = 0; h < num_rollouts; ++h) {
    for (Index s = 0; s < parts; ++s) {
      const Index begin = s * steps / parts, end = (s + 1) * steps / parts;
      const auto part = errors.middleRows(h * steps + begin, end - begin);
      sizes.row(h * parts + s) = part.array().square().colwise().mean().sqrt();
    }
  }
  return sizes;
}

// Errors over noise, squared; noise of nothing counts as a hundredth of the others'.
RowMatrix excess_of(const Misfit& m) {
  const double least = std::max(1e-4 * m.of_noise.array().square().mean(), 1e-300);
  return m.left.array().square() / m.of_noise.array().square().max(least);
}

// Of squares in a block and outside of it.
struct Means {
  double inside = 0.0, outside = 0.0;
  bool is_far() const {
    constexpr double far = 3.0;
    return inside > far * far * outside;
  }
};

Means means_of(const Vector& values, Index begin, Index end) {
  const double inside = values.segment(begin, end - begin).sum();
  const auto rest = static_cast<double>(values.size() - (end - begin));
  return {inside / static_cast<double>(end - begin), (values.sum() - inside) / std::max(1.0, rest)};
}

// The largest of several, if it is far above the others.
std::optional<Index> outlier_of(const Vector& values) {
  if (values.size() < 2) return std::nullopt;
  Index largest = 0;
  values.maxCoeff(&largest);
  return means_of(values, largest, largest + 1).is_far() ? std::optional(largest) : std::nullopt;
}

using Values = RowMatrix Rollout::*;  // states or actions

// With values as they were `samples` before, the first of all standing for those before it; or
// later, the last.
void move_column(Target& target, Values values, Index column, Index samples) {
  for (Rollout& rollout : target.rollouts) {
    const Vector before = (rollout.*values).col(column);
    for (Index t = 0; t < before.size(); ++t) {
      (rollout.*values)(t, column) = before(std::clamp<Index>(t - samples, 0, before.size() - 1));
    }
  }
}

bool is_rate(const Channel& channel) { return channel.unit.ends_with("/s"); }

Target with_later_actions(Target target, Index samples) {
  for (Index c = 0; c < target.num_actions(); ++c) {
    move_column(target, &Rollout::actions, c, samples);
  }
  return target;
}

Target with_later_rates(Target target, Index samples) {
  for (Index c = 0; c < target.num_states(); ++c) {
    if (!is_rate(target.state_channels[static_cast<std::size_t>(c)])) continue;
    move_column(target, &Rollout::states, c, samples);
  }
  return target;
}

Target scaled(Target target, Values values, double factor) {
  for (Rollout& rollout : target.rollouts) rollout.*values *= factor;
  return target;
}

Target with_time_step(Target target, double dt) {
  target.dt = dt;
  return target;
}

enum class Kind { actions, rates, clock, action_scale, state_scale };
constexpr std::size_t kNumKinds = 5;

// A change of a recording, which is made when it is needed: recordings may be large.
struct Change {
  Kind kind;
  Cause cause;
  std::function<Target(const Target&)> of;
  double unit = 1.0;  // of its errors
};

void add_moved(std::vector<Change>& changes, const Target& recording) {
  constexpr Index most_samples = 5;
  const bool has_rates = std::ranges::any_of(recording.state_channels, is_rate);
  for (Index k = 1; k <= most_samples; ++k) {
    const std::string samples = fmt::format("{} sample{}", k, k == 1 ? "" : "s");
    for (const Index later : {k, -k}) {
      const std::string change = samples + (later > 0 ? " later" : " earlier");
      if (recording.num_actions() > 0) {
        const std::string fault =
            later > 0 ? "the device reacted to actions " : "actions were recorded ";
        changes.push_back({Kind::actions,
                           {fault + samples + " late", "actions " + change},
                           [later](const Target& t) { return with_later_actions(t, later); }});
      }
      if (!has_rates) continue;
      changes.push_back(
          {Kind::rates,
           {"rates were recorded " + samples + (later > 0 ? " early" : " late"), "rates " + change},
           [later](const Target& t) { return with_later_rates(t, later); }});
    }
  }
}

void add_scaled(std::vector<Change>& changes, const Target& recording) {
  const auto add = [&](Kind kind, Values values, Cause cause, double factor) {
    const double unit = kind == Kind::state_scale ? factor : 1.0;
    changes.push_back(
        {kind, std::move(cause), [=](const Target& t) { return scaled(t, values, factor); }, unit});
  };
  const bool has_actions = recording.num_actions() > 0;
  if (has_actions) {
    add(Kind::action_scale, &Rollout::actions,
        {"actions had the opposite sign", "actions of the other sign"}, -1.0);
  }
  for (const double factor : {0.8, 0.9, 1.1, 1.25}) {
    const std::string fault =
        fmt::format(" were about {:.2f} times too {}", std::max(factor, 1.0 / factor),
                    factor < 1.0 ? "large" : "small");
    const std::string change = fmt::format(" {} times as large", factor);
    if (has_actions) {
      add(Kind::action_scale, &Rollout::actions, {"actions" + fault, "actions" + change}, factor);
    }
    add(Kind::state_scale, &Rollout::states, {"states" + fault, "states" + change}, factor);
  }
}

std::vector<Change> changes_of(const Target& recording) {
  std::vector<Change> changes;
  add_moved(changes, recording);
  for (const double factor : {0.9, 0.92, 0.94, 0.96, 0.98, 1.02, 1.04, 1.06, 1.08, 1.1}) {
    const double dt = factor * recording.dt;
    const std::string step = fmt::format("{:.4g} s", dt);
    changes.push_back({Kind::clock,
                       {fmt::format("time steps were {}, not {:.4g} s", step, recording.dt),
                        "time steps of " + step},
                       [dt](const Target& t) { return with_time_step(t, dt); }});
  }
  add_scaled(changes, recording);
  return changes;
}

}  // namespace

double size_of(const RowMatrix& errors, Index num_rollouts) {
  const Index steps = errors.rows() / num_rollouts;
  double sum = 0.0;
  for (Index h = 0; h < num_rollouts; ++h) {
    sum += errors.middleRows(h * steps, steps).array().square().colwise().mean().sqrt().mean();
  }
  return sum / static_cast<double>(num_rollouts);
}

Misfit misfit(const RowMatrix& errors, const std::vector<RowMatrix>& draws, Index num_rollouts) {
  if (num_rollouts < 1 || draws.size() < 2 || errors.rows() % num_rollouts != 0) {
    throw ShapeError(fmt::format("misfit: {} rows of errors, {} rollouts, {} draws", errors.rows(),
                                 num_rollouts, draws.size()));
  }
  Misfit found{num_rollouts, sizes_by_part(errors, num_rollouts), {}};
  Vector sizes(std::ssize(draws));
  RowMatrix squares = RowMatrix::Zero(found.left.rows(), found.left.cols());
  for (Index b = 0; b < sizes.size(); ++b) {
    const RowMatrix& draw = draws[static_cast<std::size_t>(b)];
    if (draw.rows() != errors.rows() || draw.cols() != errors.cols()) {
      throw ShapeError("misfit: draws of another shape than the errors");
    }
    squares += sizes_by_part(draw, num_rollouts).cwiseAbs2();
    sizes(b) = size_of(draw, num_rollouts);
  }
  found.of_noise = (squares / static_cast<double>(sizes.size())).cwiseSqrt();
  const double mean = sizes.mean();
  found.times = size_of(errors, num_rollouts) / mean;
  const double variance =
      (sizes.array() - mean).square().sum() / static_cast<double>(sizes.size() - 1);
  found.deviation = std::sqrt(variance) / mean;
  return found;
}

std::optional<Concentration> concentration(const Misfit& m) {
  const RowMatrix excess = excess_of(m);
  const Index parts = excess.rows() / m.num_rollouts;
  Vector of_parts = Vector::Zero(parts);
  for (Index i = 0; i < excess.rows(); ++i) of_parts(i % parts) += excess.row(i).mean();
  Concentration found{.begin = 0, .end = parts, .channel = {}, .rollout = {}};
  bool is_shorter = false;
  for (Index length = 1; length <= parts / 2 && !is_shorter; ++length) {
    double most = 0.0;
    for (Index begin = 0; begin + length <= parts; ++begin) {
      const Means means = means_of(of_parts, begin, begin + length);
      if (!means.is_far() || means.inside < most) continue;
      most = means.inside;
      is_shorter = true;
      found.begin = begin;
      found.end = begin + length;
    }
  }
  RowMatrix there(m.num_rollouts, excess.cols());
  for (Index h = 0; h < there.rows(); ++h) {
    there.row(h) =
        excess.middleRows(h * parts + found.begin, found.end - found.begin).colwise().mean();
  }
  found.channel = outlier_of(there.colwise().mean().transpose());
  found.rollout = outlier_of(found.channel ? Vector(there.col(*found.channel))
                                           : Vector(there.rowwise().mean()));
  if (!is_shorter && !found.channel && !found.rollout) return std::nullopt;
  double inside = 0.0, num_inside = 0.0;
  for (Index i = 0; i < excess.rows(); ++i) {
    const bool in_part = i % parts >= found.begin && i % parts < found.end;
    if (!in_part || i / parts != found.rollout.value_or(i / parts)) continue;
    for (Index c = 0; c < excess.cols(); ++c) {
      if (c != found.channel.value_or(c)) continue;
      inside += excess(i, c);
      num_inside += 1.0;
    }
  }
  found.there = std::sqrt(inside / num_inside);
  const double num_outside = static_cast<double>(excess.size()) - num_inside;
  found.elsewhere = std::sqrt(std::max(0.0, excess.sum() - inside) / num_outside);
  return found;
}

std::optional<Cause> likeliest_cause(const FitProblem& problem, const Target& recording,
                                     const Vector& theta) {
  FitProblem in_parts = problem;
  in_parts.segment_length = first_length(problem, recording);
  const Fit start = fit(in_parts, recording, theta);
  if (start.errors.size() == 0) return std::nullopt;
  const std::vector<Change> changes = changes_of(recording);
  std::array<const Change*, kNumKinds> best_of_kinds{};
  Vector sizes = Vector::Constant(kNumKinds, kInfinity);
  for (const Change& change : changes) {
    const RowMatrix errors = errors_after_step(in_parts, change.of(recording), start);
    if (errors.size() == 0) continue;  // the simulator refuses it
    const double size = size_of(errors, recording.num_rollouts()) / change.unit;
    if (!(size < sizes(static_cast<Index>(change.kind)))) continue;
    sizes(static_cast<Index>(change.kind)) = size;
    best_of_kinds[static_cast<std::size_t>(change.kind)] = &change;
  }
  constexpr double clearly = 0.98;  // less: of linear motion scales of actions and states are one
  std::optional<Cause> likeliest;
  for (const Change* change : best_of_kinds) {
    if (change == nullptr) continue;
    const Fit found = fit(problem, change->of(recording), start.theta);
    if (found.errors.size() == 0) continue;
    const double left = size_of(found.errors, recording.num_rollouts()) / change->unit;
    if (likeliest && !(left < clearly * likeliest->size)) continue;
    likeliest = change->cause;
    likeliest->size = left;
  }
  return likeliest;
}

}  // namespace npdr::analysis
