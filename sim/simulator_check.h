/// Checks that every simulator makes of its settings, its parameters and its target.
#pragma once

#include <map>
#include <sstream>
#include <string>

#include "core/error.h"
#include "core/target.h"
#include "sim/simulator.h"

namespace npdr::sim {

/// Throws InputError: "simulator.<field> = <found>, must be <allowed>".
template <typename Value>
[[noreturn]] void reject_setting(const std::string& field, const Value& found,
                                 const std::string& allowed) {
  std::ostringstream message;
  message << "simulator." << field << " = " << found << ", must be " << allowed;
  throw InputError(message.str());
}

/// Nominal values become those of `values`. Throws InputError for an unknown name or a value that
/// is physically impossible; `field` is where the values come from.
void replace_nominal(const std::map<std::string, double>& values, SimulatorInfo& info,
                     const std::string& field = "simulator.parameters");

/// Throws InputError unless the target is valid, has the simulator's channels and is long enough
/// for store_every.
void check_target(const Target& target, const SimulatorInfo& info, Index store_every);

/// Throws ShapeError unless there are as many parameters as the simulator has.
void check_num_parameters(Index num_parameters, const SimulatorInfo& info);

/// The target that behave(theta, num_rollouts) fills: its dt, channels and source. Throws
/// ShapeError for a theta of another length, InputError for fewer than one rollout.
Target begin_target(const Vector& theta, Index num_rollouts, const SimulatorInfo& info);

/// Whether each of the P parameters is within its limits; NaN isn't.
bool is_possible(const Eigen::Ref<const Eigen::RowVectorXd>& theta, const SimulatorInfo& info);

}  // namespace npdr::sim
