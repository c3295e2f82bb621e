/// Settings of the mini golf (minigolf.h).
#pragma once

#include <string>
#include <vector>

#include "core/range.h"
#include "core/types.h"

namespace npdr::sim {

struct MinigolfConfig {
  static constexpr Range kSubsteps = {1, 1000};  ///< both numbers of them
  static constexpr Range kSolverIterations = {1, 10'000};
  static constexpr Range kPart = {0.0, 1.0};  ///< dampings, cfm and erp
  static constexpr Range kRestitutionThreshold = {0.0, 100.0};

  std::string strike = "recorded";      ///< "recorded" actions, or Table A4's "policy"
  std::string ball_start = "recorded";  ///< in each rollout, or "nominal"
  std::string rolling = "exact";        ///< away from everything, or "engine": by Bullet, too
  Index substeps = 2;                   ///< of Bullet per time step
  Index substeps_near = 5;              ///< the same where the ball is near something
  double linear_damping = 0.1;          ///< [1] v loses the factor (1 - damping)^(1 s) by itself
  double angular_damping = 0.0;         ///< [1] of the ball's spin
  Index solver_iterations = 100;        ///< of Bullet's contact solver, at most
  double solver_cfm = 1e-4;             ///< constraint force mixing: softness of contacts
  double solver_erp = 0.2;              ///< part of an overlap that a substep takes away
  double restitution_threshold = 0.2;   ///< [m/s] contacts below it don't bounce
};

/// What MinigolfConfig::strike, ball_start and rolling can be.
std::vector<std::string> strike_names();
std::vector<std::string> ball_start_names();
std::vector<std::string> rolling_names();

}  // namespace npdr::sim
