#include "sim/minigolf/bullet_scene.h"

#include <array>

#include "sim/minigolf/head.h"

namespace npdr::sim {
namespace {

// Bullet multiplies it with the size of the shapes, sqrt(3) r for a ball: contacts of this ball are
// found up to 17 um apart, and with Bullet's own 0.02 they would be up to 0.7 mm. The variable is
// global: set before any world exists.
[[maybe_unused]] const double kContactBreakingThreshold = gContactBreakingThreshold = 5e-4;

// Bullet limits the torque of rolling friction about two fixed axes, each by itself: a ball that
// rolls obliquely slows down up to 1.41 times as fast, and turns. On the ground it comes from
// BallWorld::resist_rolling() instead. Global, too.
constexpr int kGround = 1;
btScalar rolling_friction_off_ground(const btCollisionObject* a, const btCollisionObject* b) {
  if (a->getUserIndex() == kGround || b->getUserIndex() == kGround) return 0.0;
  return a->getRollingFriction() * b->getFriction() + b->getRollingFriction() * a->getFriction();
}
[[maybe_unused]] const auto kRollingFrictionCallback = gCalculateCombinedRollingFrictionCallback =
    rolling_friction_off_ground;

btDefaultCollisionConstructionInfo small_pools() {
  btDefaultCollisionConstructionInfo info;
  info.m_defaultMaxPersistentManifoldPoolSize = 32;
  info.m_defaultMaxCollisionAlgorithmPoolSize = 32;
  return info;
}

}  // namespace

btVector3 to_bullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btTransform to_bullet(const Eigen::Isometry3d& pose) {
  const auto r = pose.linear();
  const btMatrix3x3 rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                             r(2, 2));
  return btTransform(rotation, to_bullet(pose.translation()));
}

void set_surface(const Surface& surface, btRigidBody& body) {
  body.setFriction(surface.friction);
  body.setRollingFriction(surface.rolling_friction);
  body.setRestitution(surface.restitution);
}

BulletScene::BulletScene(const MinigolfConfig& config, const Course& course)
    : configuration_(small_pools()),
      dispatcher_(&configuration_),
      world_(&dispatcher_, &broadphase_, &solver_, &configuration_),
      ball_shape_(course.ball_radius) {
  set_solver(config, course);
  add_ground(course);
  for (const CourseBox& box : bounds()) add_box(box);
  for (const CourseBox& box : course.obstacles) add_box(box);
  add_ball(config, course);
  make_club();
}

BulletScene::~BulletScene() {
  for (int i = world_.getNumCollisionObjects() - 1; i >= 0; --i) {
    world_.removeCollisionObject(world_.getCollisionObjectArray()[i]);
  }
}

void BulletScene::set_solver(const MinigolfConfig& config, const Course& course) {
  btContactSolverInfo& info = world_.getSolverInfo();
  info.m_numIterations = static_cast<int>(config.solver_iterations);
  info.m_leastSquaresResidualThreshold = 1e-16;
  // In units of 1 / mass. Relative to it, the ball's mass changes nothing, as in nature.
  info.m_globalCfm = config.solver_cfm * kNominalMass / course.ball_mass;
  info.m_erp2 = config.solver_erp;
  // Positions are corrected apart from velocities, from the first overlap on: otherwise the
  // correction adds to the restitution.
  info.m_splitImpulse = 1;
  info.m_splitImpulsePenetrationThreshold = 0.0;
  info.m_restitutionVelocityThreshold = config.restitution_threshold;
  info.m_solverMode = SOLVER_FRICTION_SEPARATE | SOLVER_USE_2_FRICTION_DIRECTIONS;
  world_.setForceUpdateAllAabbs(false);
  world_.setGravity(btVector3(0, 0, -kGravity));
}

void BulletScene::add_ground(const Course& course) {
  ground_ = std::make_unique<btRigidBody>(0.0, nullptr, &ground_shape_);
  set_surface(course.ground, *ground_);
  ground_->setUserIndex(kGround);
  world_.addRigidBody(ground_.get());
}

void BulletScene::add_box(const CourseBox& box) {
  box_shapes_.push_back(
      std::make_unique<btBoxShape>(btVector3(box.half_x, box.half_y, box.half_z)));
  boxes_.push_back(std::make_unique<btRigidBody>(0.0, nullptr, box_shapes_.back().get()));
  btRigidBody& body = *boxes_.back();
  set_surface(kFixtures, body);
  body.setWorldTransform(
      btTransform(btQuaternion(btVector3(0, 0, 1), box.yaw), btVector3(box.x, box.y, box.half_z)));
  world_.addRigidBody(&body);
}

void BulletScene::add_ball(const MinigolfConfig& config, const Course& course) {
  btVector3 inertia;
  ball_shape_.calculateLocalInertia(course.ball_mass, inertia);
  ball_ = std::make_unique<btRigidBody>(course.ball_mass, nullptr, &ball_shape_, inertia);
  set_surface(course.ball, *ball_);
  ball_->setDamping(config.linear_damping, config.angular_damping);
  ball_->setActivationState(DISABLE_DEACTIVATION);
  world_.addRigidBody(ball_.get());
}

void BulletScene::make_club() {
  std::array<btVector3, 4> centers = {
      btVector3(-kHeadHalfX, -kHeadHalfY, 0), btVector3(-kHeadHalfX, kHeadHalfY, 0),
      btVector3(kHeadHalfX, -kHeadHalfY, 0), btVector3(kHeadHalfX, kHeadHalfY, 0)};
  std::array<btScalar, 4> radii;
  radii.fill(kHeadRadius);
  head_shape_ = std::make_unique<btMultiSphereShape>(centers.data(), radii.data(), 4);
  head_shape_->setMargin(kHeadRadius);  // of points, whose margin is the sphere
  club_ = std::make_unique<btRigidBody>(0.0, nullptr, head_shape_.get());
  set_surface(kFixtures, *club_);
  // Kinematic and nothing else: a static body has no velocity.
  club_->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  club_->setActivationState(DISABLE_DEACTIVATION);
}

}  // namespace npdr::sim
