/// The Bullet objects of one rollout: ground, bounds, obstacles, ball and club, and the solver's
/// settings. BallWorld (ball_world.h) moves them.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "sim/minigolf/course.h"
#include "sim/simulator.h"

namespace npdr::sim {

btVector3 to_bullet(const Eigen::Vector3d& v);
btTransform to_bullet(const Eigen::Isometry3d& pose);
Eigen::Vector3d from_bullet(const btVector3& v);

/// Gives a body the frictions and the restitution of a surface.
void set_surface(const Surface& surface, btRigidBody& body);

/// Everything but the club is in the world from the beginning.
class BulletScene {
 public:
  BulletScene(const MinigolfConfig& config, const Course& course);
  ~BulletScene();
  BulletScene(const BulletScene&) = delete;
  BulletScene& operator=(const BulletScene&) = delete;

  btDiscreteDynamicsWorld& world() { return world_; }
  btCollisionDispatcher& dispatcher() { return dispatcher_; }
  btRigidBody& ground() { return *ground_; }
  btRigidBody& ball() { return *ball_; }
  const btRigidBody& ball() const { return *ball_; }
  btRigidBody& club() { return *club_; }

 private:
  void set_solver(const MinigolfConfig& config, const Course& course);
  void add_ground(const Course& course);
  void add_box(const CourseBox& box);
  void add_ball(const MinigolfConfig& config, const Course& course);
  void make_club();

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btSimpleBroadphase broadphase_{16};
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;

  btStaticPlaneShape ground_shape_{btVector3(0, 0, 1), 0.0};
  btSphereShape ball_shape_;
  std::unique_ptr<btMultiSphereShape> head_shape_;
  std::vector<std::unique_ptr<btBoxShape>> box_shapes_;
  std::vector<std::unique_ptr<btRigidBody>> boxes_;
  std::unique_ptr<btRigidBody> ground_, ball_, club_;
};

}  // namespace npdr::sim
