/// Settings of the mini golf (minigolf.h).
#pragma once

#include "core/enum_names.h"
#include "core/range.h"
#include "core/types.h"

namespace npdr::sim {

/// The joint angles of a strike: the recorded actions, or the policy of Table A4.
enum class Strike { recorded, policy };
constexpr auto enum_table(Strike) {
  return std::to_array<EnumRow<Strike>>(
      {{Strike::recorded, "recorded"}, {Strike::policy, "policy"}});
}

/// The ball's first place: as recorded in each rollout, or the nominal one.
enum class BallStart { recorded, nominal };
constexpr auto enum_table(BallStart) {
  return std::to_array<EnumRow<BallStart>>(
      {{BallStart::recorded, "recorded"}, {BallStart::nominal, "nominal"}});
}

/// Computation of a ball that rolls away from everything: in closed form, or by Bullet as all else.
enum class Rolling { exact, engine };
constexpr auto enum_table(Rolling) {
  return std::to_array<EnumRow<Rolling>>({{Rolling::exact, "exact"}, {Rolling::engine, "engine"}});
}

struct MinigolfConfig {
  static constexpr Range kSubsteps = {1, 1000};  ///< both numbers of them
  static constexpr Range kSolverIterations = {1, 10'000};
  static constexpr Range kPart = {0.0, 1.0};  ///< dampings, cfm and erp
  static constexpr Range kRestitutionThreshold = {0.0, 100.0};

  Strike strike = Strike::recorded;
  BallStart ball_start = BallStart::recorded;
  Rolling rolling = Rolling::exact;
  Index substeps = 2;                  ///< of Bullet per time step
  Index substeps_near = 5;             ///< the same where the ball is near something
  double linear_damping = 0.1;         ///< [1] v loses the factor (1 - damping)^(1 s) by itself
  double angular_damping = 0.0;        ///< [1] of the ball's spin
  Index solver_iterations = 100;       ///< of Bullet's contact solver, at most
  double solver_cfm = 1e-4;            ///< constraint force mixing: softness of contacts
  double solver_erp = 0.2;             ///< part of an overlap that a substep takes away
  double restitution_threshold = 0.2;  ///< [m/s] contacts below it don't bounce
};

}  // namespace npdr::sim
