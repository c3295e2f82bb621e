#include "sim/minigolf/ball_world.h"

#include <algorithm>
#include <cmath>

#include "sim/minigolf/bullet_scene.h"

namespace npdr::sim {
namespace {

constexpr double kNear = 0.002;       // [m] gap below which a step has the fine substeps
constexpr double kRolling = 1e-4;     // [m], [m/s] off the ground, or slipping, that rolling may be
constexpr double kClubMargin = 0.02;  // [m] gap below which the club is in the world
constexpr double kRestSpeed = 1e-3;   // [m/s]
constexpr double kRestTime = 0.1;     // [s]

// Coefficients of two bodies in contact, as Bullet combines theirs (course.h).
double friction(const Surface& a, const Surface& b) { return a.friction * b.friction; }
double rolling_friction(const Surface& a, const Surface& b) {
  return a.rolling_friction * b.friction + b.rolling_friction * a.friction;
}

// Rate [1/s] of a damping that takes the factor (1 - damping)^t.
double rate(double damping) { return -std::log1p(-damping); }

RollingLaw rolling_law(const MinigolfConfig& config, const Course& course) {
  const double mu = rolling_friction(course.ball, course.ground);
  return {5.0 / 7.0 * kGravity * mu / course.ball_radius,
          (5.0 * rate(config.linear_damping) + 2.0 * rate(config.angular_damping)) / 7.0};
}

// Distance of a place from the hole's edge.
double gap_of_hole(const Eigen::Vector3d& p) {
  return std::abs(std::hypot(p.x() - kHoleX, p.y() - kHoleY) - kHoleRadius);
}

std::array<Footprint, 5> footprints(const Course& course) {
  const auto& [outer, inner, end] = bounds();
  const auto& [left, right] = course.obstacles;
  return {Footprint(outer), Footprint(inner), Footprint(end), Footprint(left), Footprint(right)};
}

}  // namespace

BallWorld::BallWorld(const MinigolfConfig& config, const Course& course, const ClubMotion& motion,
                     double dt, const Eigen::Vector2d& start)
    : course_(course),
      motion_(motion),
      dt_(dt),
      footprints_(footprints(course)),
      rolling_(rolling_law(config, course)),
      rolls_exactly_(config.rolling == Rolling::exact),
      linear_rate_(rate(config.linear_damping)),
      scene_(std::make_unique<BulletScene>(config, course)) {
  set_ball({start.x(), start.y(), course.ball_radius}, Eigen::Vector3d::Zero(),
           Eigen::Vector3d::Zero());
}

BallWorld::~BallWorld() = default;

void BallWorld::set_ball(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity,
                         const Eigen::Vector3d& spin) {
  btRigidBody& ball = scene_->ball();
  const btTransform pose(btQuaternion::getIdentity(), to_bullet(position));
  ball.setWorldTransform(pose);
  ball.setInterpolationWorldTransform(pose);
  ball.setLinearVelocity(to_bullet(velocity));
  ball.setAngularVelocity(to_bullet(spin));
  ball.updateInertiaTensor();
}

Eigen::Vector3d BallWorld::ball_position() const {
  return from_bullet(scene_->ball().getWorldTransform().getOrigin());
}

Eigen::Vector3d BallWorld::ball_velocity() const {
  return from_bullet(scene_->ball().getLinearVelocity());
}

Eigen::Vector3d BallWorld::ball_spin() const {
  return from_bullet(scene_->ball().getAngularVelocity());
}

// Distance of the ball's surface from the next box or the hole's edge, seen from above.
double BallWorld::gap() const {
  const Eigen::Vector3d p = ball_position();
  double nearest = gap_of_hole(p);
  for (const Footprint& footprint : footprints_) {
    nearest = std::min(nearest, footprint.distance(p.x(), p.y()) - course_.ball_radius);
  }
  return nearest;
}

// Whether no box comes nearer while the ball rolls straight on: one that is left behind at first,
// being convex, stays behind.
bool BallWorld::rolls_away(double reach) const {
  const Eigen::Vector3d p = ball_position();
  const Eigen::Vector2d v = ball_velocity().head<2>();
  if (gap_of_hole(p) < kNear + reach) return false;
  return std::ranges::all_of(footprints_, [&](const Footprint& footprint) {
    const Eigen::Vector2d outward = footprint.outward(p.x(), p.y());
    const double gap = outward.norm() - course_.ball_radius;
    return gap > kNear + reach || (gap > -kRolling && outward.dot(v) >= 0.0);
  });
}

void BallWorld::step(Index t) {
  const Eigen::Vector3d position = ball_position();
  const double reach = ball_velocity().norm() * dt_;
  const double club_gap = motion_.clearance(t, position) - course_.ball_radius - reach;
  const bool with_club = club_gap < kClubMargin;
  const bool is_near = gap() < kNear + reach;
  if (!with_club && (!is_near || rolls_away(reach)) && rolls()) {
    roll_on();
    club_moves_ = false;
    ++counts_.rolled;
  } else {
    simulate(t, with_club, is_near || club_gap < kNear);
  }
  watch_rest(t);
}

// Whether the ball rolls without slipping and the ground can hold it so (rolling.h).
bool BallWorld::rolls() const {
  if (!rolls_exactly_) return false;
  const Eigen::Vector3d p = ball_position(), v = ball_velocity(), spin = ball_spin();
  const double r = course_.ball_radius;
  const double slip = std::hypot(v.x() - r * spin.y(), v.y() + r * spin.x());
  if (std::max({std::abs(p.z() - r), std::abs(v.z()), slip}) > kRolling) return false;
  const double held =
      rolling_.deceleration() + (rolling_.damping() - linear_rate_) * v.head<2>().norm();
  return std::abs(held) < friction(course_.ball, course_.ground) * kGravity && !is_above_hole();
}

void BallWorld::roll_on() {
  const Eigen::Vector3d p = ball_position(), v = ball_velocity();
  const double speed = v.head<2>().norm();
  if (speed == 0.0) return;
  const Rolled rolled = rolling_.roll(speed, dt_);
  const Eigen::Vector2d along = v.head<2>() / speed;
  const Eigen::Vector2d place = p.head<2>() + rolled.distance * along;
  const Eigen::Vector2d velocity = rolled.speed * along;
  const double r = course_.ball_radius;
  set_ball({place.x(), place.y(), p.z()}, {velocity.x(), velocity.y(), 0.0},
           {-velocity.y() / r, velocity.x() / r, ball_spin().z()});
}

void BallWorld::simulate(Index t, bool with_club, bool is_fine) {
  ++(is_fine ? counts_.fine : counts_.coarse);
  set_club_present(with_club, t, is_fine);
  const Index substeps = motion_.num_substeps(is_fine);
  for (Index k = 0; k < substeps; ++k) {
    if (with_club) scene_->club().setWorldTransform(to_bullet(motion_.pose(t, k, is_fine)));
    step_once(dt_ / static_cast<double>(substeps));
  }
}

void BallWorld::watch_rest(Index t) {
  const double speed = ball_velocity().norm();
  const double rolling = ball_spin().head<2>().norm() * course_.ball_radius;
  steps_at_rest_ = speed < kRestSpeed && rolling < kRestSpeed ? steps_at_rest_ + 1 : 0;
  club_is_done_ = steps_at_rest_ > 0 &&
                  motion_.clearance_from(t, ball_position()) - course_.ball_radius > kClubMargin;
}

// A club that joins at the beginning of step t, or waited while the ball rolled in closed form, has
// the velocity that it has from there on.
void BallWorld::set_club_present(bool with_club, Index t, bool is_fine) {
  btRigidBody& club = scene_->club();
  if (with_club && !club_moves_) {
    const btTransform pose = to_bullet(motion_.pose(t, -1, is_fine));
    club.setWorldTransform(pose);
    club.setInterpolationWorldTransform(pose);
  }
  club_moves_ = with_club;
  if (with_club == club_is_here_) return;
  club_is_here_ = with_club;
  if (with_club) {
    scene_->world().addRigidBody(&club, btBroadphaseProxy::KinematicFilter,
                                 btBroadphaseProxy::DefaultFilter);
  } else {
    scene_->world().removeRigidBody(&club);
  }
}

void BallWorld::step_once(double duration) {
  // A rolling sphere would keep some stale contacts behind the true one, which push it.
  for (int i = 0; i < scene_->dispatcher().getNumManifolds(); ++i) {
    scene_->dispatcher().getManifoldByIndexInternal(i)->clearManifold();
  }
  const Surface& ground = is_above_hole() ? kHoleSurface : course_.ground;
  set_surface(ground, scene_->ground());
  resist_rolling(ground, duration);
  scene_->world().stepSimulation(duration, 0);
}

bool BallWorld::is_above_hole() const {
  const Eigen::Vector3d p = ball_position();
  return std::hypot(p.x() - kHoleX, p.y() - kHoleY) < kHoleRadius;
}

// A torque of at most mu_c m g against the rolling, and no more than what takes the spin and, with
// the ground's friction in this substep, the velocity that goes with it. More would turn the spin
// around: a rolling ball's momentum about the point of contact is 7/5 m r^2 |w|, but where friction
// doesn't hold it, only the 2/5 of its spin are there to be taken.
void BallWorld::resist_rolling(const Surface& ground, double duration) {
  const double r = course_.ball_radius;
  if (ball_position().z() - r > kRolling) return;
  const Eigen::Vector2d spin = ball_spin().head<2>();
  const double size = spin.norm();
  if (size == 0.0) return;
  const Eigen::Vector2d forward(spin.y() / size, -spin.x() / size);
  const double grip = std::clamp(ball_velocity().head<2>().dot(forward), 0.0,
                                 friction(course_.ball, ground) * kGravity * duration);
  const double torque = rolling_friction(course_.ball, ground) * kGravity;
  const double impulse = std::min(torque * duration, 0.4 * r * r * size + r * grip);
  const Eigen::Vector2d change = -impulse * course_.ball_mass / size * spin;
  scene_->ball().applyTorqueImpulse(btVector3(change.x(), change.y(), 0.0));
}

bool BallWorld::has_come_to_rest() const {
  return static_cast<double>(steps_at_rest_) * dt_ > kRestTime - 0.5 * dt_ && club_is_done_;
}

}  // namespace npdr::sim
