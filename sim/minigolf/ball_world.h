/// A Bullet world that holds the course, the ball and the club.
///
/// The ball is the only body that forces move; the club moves as it is told, and its velocity
/// reaches the ball. A world simulates one rollout; none shares anything with another, so the bits
/// of a rollout depend on nothing but its own course and club.
///
/// While the ball rolls without slipping, away from what is within its reach, a step follows the
/// closed form (rolling.h) unless the config wants the engine for that, too: same motion, less
/// time.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>

#include "sim/minigolf/club_motion.h"
#include "sim/minigolf/course.h"
#include "sim/minigolf/rolling.h"
#include "sim/simulator.h"

namespace npdr::sim {

class BulletScene;

/// Numbers of steps of a world: along the closed form, with `substeps`, and with `substeps_near`.
struct StepCounts {
  Index rolled = 0, coarse = 0, fine = 0;
};

class BallWorld {
 public:
  /// The ball begins at rest at (x, y). `motion` must outlive the world.
  BallWorld(const MinigolfConfig& config, const Course& course, const ClubMotion& motion, double dt,
            const Eigen::Vector2d& start);
  ~BallWorld();
  BallWorld(const BallWorld&) = delete;
  BallWorld& operator=(const BallWorld&) = delete;

  /// Advances from the beginning of step t to its end. Steps follow each other.
  void step(Index t);

  Eigen::Vector3d ball_position() const;  ///< [m]
  Eigen::Vector3d ball_velocity() const;  ///< [m/s]
  Eigen::Vector3d ball_spin() const;      ///< [rad/s]

  /// Whether the ball has rested for 0.1 s and the club won't touch it any more, so that it stays
  /// where it is.
  bool has_come_to_rest() const;

  const StepCounts& step_counts() const { return counts_; }

  /// Sets the ball's state, for experiments with the world itself.
  void set_ball(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity,
                const Eigen::Vector3d& spin);

 private:
  double gap() const;
  bool rolls() const;
  bool rolls_away(double reach) const;
  void roll_on();
  void simulate(Index t, bool with_club, bool is_fine);
  void set_club_present(bool with_club, Index t, bool is_fine);
  void step_once(double duration);
  bool is_above_hole() const;
  void resist_rolling(const Surface& ground, double duration);
  void watch_rest(Index t);

  const Course course_;
  const ClubMotion& motion_;
  const double dt_;
  const std::array<Footprint, 5> footprints_;
  const RollingLaw rolling_;
  const bool rolls_exactly_;
  const double linear_rate_;  // [1/s] at which damping takes velocity
  std::unique_ptr<BulletScene> scene_;
  StepCounts counts_;
  bool club_is_here_ = false;  // in the engine's world
  bool club_moves_ = false;    // and was there in the last step
  bool club_is_done_ = false;
  int steps_at_rest_ = 0;
};

}  // namespace npdr::sim
