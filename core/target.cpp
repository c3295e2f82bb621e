#include "core/target.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "core/error.h"

namespace npdr {
namespace {

void check_shape(const std::string& where, const std::string& what, const RowMatrix& values,
                 Index rows, Index cols) {
  if (values.rows() == rows && values.cols() == cols) return;
  std::ostringstream message;
  message << where << ": " << what << " has shape (" << values.rows() << ", " << values.cols()
          << "), must be (" << rows << ", " << cols << ")";
  throw InputError(message.str());
}

// `largest`: magnitude that is allowed.
void check_values(const std::string& where, const std::string& what, const RowMatrix& values,
                  const std::vector<Channel>& channels, double largest) {
  for (Index t = 0; t < values.rows(); ++t) {
    for (Index c = 0; c < values.cols(); ++c) {
      if (std::abs(values(t, c)) <= largest) continue;
      std::ostringstream message;
      message << where << ": " << what << " of channel '"
              << channels[static_cast<std::size_t>(c)].label << "' is " << values(t, c)
              << " at step " << t << ", must be ";
      if (std::isfinite(values(t, c))) message << "of magnitude " << largest << " or less";
      if (!std::isfinite(values(t, c))) message << "finite";
      message << "; repair or leave out this recording";
      throw InputError(message.str());
    }
  }
}

}  // namespace

void Target::check(const std::string& where) const {
  if (!(dt > 0.0) || !std::isnormal(dt)) {
    std::ostringstream message;
    message << where << ": dt = " << dt << ", must be a positive time [s], and not below 1e-307";
    throw InputError(message.str());
  }
  if (rollouts.empty() || num_steps() < 1) {
    throw InputError(where + ": no rollout with at least one step");
  }
  for (std::size_t h = 0; h < rollouts.size(); ++h) {
    const Rollout& r = rollouts[h];
    const std::string which = " of rollout " + std::to_string(h) + " ('" + r.name + "')";
    check_shape(where, "states" + which, r.states, num_steps() + 1, num_states());
    check_shape(where, "actions" + which, r.actions, num_steps(), num_actions());
    // Simulated states, and features made of them, are kept in single precision.
    check_values(where, "state" + which, r.states, state_channels,
                 std::numeric_limits<float>::max());
    check_values(where, "action" + which, r.actions, action_channels,
                 std::numeric_limits<double>::max());
  }
}

Target Target::first(Index count) const {
  if (count < 1 || count > num_rollouts()) {
    throw InputError("num_rollouts = " + std::to_string(count) + ", but the target domain has " +
                     std::to_string(num_rollouts()) + " rollouts");
  }
  Target result = *this;
  result.rollouts.resize(static_cast<std::size_t>(count));
  return result;
}

Target Target::after(Index count) const {
  if (count < 0 || count >= num_rollouts()) {
    throw InputError("no rollouts after the first " + std::to_string(count) +
                     ": the target domain has " + std::to_string(num_rollouts()));
  }
  Target result = *this;
  result.rollouts.erase(result.rollouts.begin(), result.rollouts.begin() + count);
  return result;
}

Target Target::pick(const std::vector<Index>& positions) const {
  if (positions.empty()) throw InputError("no rollouts of the target domain were picked");
  Target result = *this;
  result.rollouts.clear();
  for (const Index position : positions) {
    if (position < 0 || position >= num_rollouts()) {
      throw InputError("no rollout " + std::to_string(position + 1) + ": the target domain has " +
                       std::to_string(num_rollouts()));
    }
    result.rollouts.push_back(rollouts[static_cast<std::size_t>(position)]);
  }
  return result;
}

}  // namespace npdr
