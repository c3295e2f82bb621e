/// A sphere that rolls on level ground without slipping, away from everything else: its motion has
/// a closed form, so no step size enters.
///
/// With r the radius, mu_c the rolling friction of ball and ground together [m] (Surface,
/// course.h), c_l and c_a the rates [1/s] at which damping takes velocity and spin, and a solid
/// sphere's inertia of (2/5) m r^2, the speed v along a straight line follows
///   dv/dt = -(a + b v),   a = (5/7) g mu_c / r,   b = (5 c_l + 2 c_a) / 7,
/// until it is 0. The ground's friction holds the sphere while it must give less than mu g:
///   |a + (b - c_l) v| < mu g.
#pragma once

namespace npdr::sim {

/// Distance [m] and final speed [m/s] of a stretch of rolling.
struct Rolled {
  double distance = 0.0;
  double speed = 0.0;
};

class RollingLaw {
 public:
  /// `deceleration` a [m/s^2] and `damping` b [1/s], neither negative.
  RollingLaw(double deceleration, double damping) : a_(deceleration), b_(damping) {}

  double deceleration() const { return a_; }
  double damping() const { return b_; }

  /// `speed` [m/s] and `duration` [s], neither negative.
  Rolled roll(double speed, double duration) const;

 private:
  double time_to_rest(double speed) const;

  double a_, b_;
};

}  // namespace npdr::sim
