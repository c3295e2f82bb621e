#include "sim/minigolf/minigolf.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "core/constants.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"
#include "sim/minigolf/arm.h"
#include "sim/minigolf/ball_world.h"
#include "sim/simulator_check.h"

namespace npdr::sim {
namespace {

constexpr double kTimeStep = 0.01;
constexpr Index kSteps = 800;
constexpr double kStartSpread = 0.005;    // [m] of the ball's place in a simulated target domain
constexpr double kSunk = 0.5;             // radii below its place on the ground
constexpr double kMaxJointAngle = 100.0;  // [rad]
constexpr double kMinTimeStep = 1e-4, kMaxTimeStep = 1.0;  // [s]
constexpr double kGoalRadius = 0.05, kGoalSpeed = 0.01;    // [m], [m/s]

SimulatorInfo make_info() {
  SimulatorInfo info;
  info.name = "minigolf";
  info.description = "a robot arm's strike of a mini golf ball";
  info.parameters = course_parameters();
  info.state_channels = {{"ball_x", "m"}, {"ball_y", "m"}};
  for (std::size_t j = 1; j <= kNumJoints; ++j) {
    info.action_channels.push_back({fmt::format("q{}_cmd", j), "rad"});
  }
  info.goal = Goal{"rests within 5 cm of the hole",
                   {0, 1},
                   Eigen::Vector2d(kHoleX, kHoleY),
                   kGoalRadius,
                   kGoalSpeed};
  info.dt = kTimeStep;
  info.num_steps = kSteps;
  return info;
}

void check_range(const std::string& field, double found, const Range& allowed) {
  if (allowed.contains(found)) return;
  std::ostringstream range;
  range << "in [" << allowed.low << ", " << allowed.high << "]";
  reject_setting(field, found, range.str());
}

void check_config(const SimulatorConfig& config) {
  if (config.segment_length != 0) {
    reject_setting("segment_length", config.segment_length,
                   "0: a recording doesn't hold the ball's velocity, from which a segment begins");
  }
  if (config.substeps != 1) {
    reject_setting("substeps", config.substeps, "1 with 'minigolf', which has minigolf.substeps");
  }
  if (config.store_every < 1) reject_setting("store_every", config.store_every, ">= 1");
  const MinigolfConfig& golf = config.minigolf;
  check_range("minigolf.substeps", double(golf.substeps), golf.kSubsteps);
  check_range("minigolf.substeps_near", double(golf.substeps_near), golf.kSubsteps);
  check_range("minigolf.solver_iterations", double(golf.solver_iterations), golf.kSolverIterations);
  check_range("minigolf.linear_damping", golf.linear_damping, golf.kPart);
  check_range("minigolf.angular_damping", golf.angular_damping, golf.kPart);
  check_range("minigolf.solver_cfm", golf.solver_cfm, golf.kPart);
  check_range("minigolf.solver_erp", golf.solver_erp, golf.kPart);
  check_range("minigolf.restitution_threshold", golf.restitution_threshold,
              golf.kRestitutionThreshold);
}

// Data that all simulations of one rollout of the target share.
struct Task {
  ClubMotion motion;
  Eigen::Vector2d start;
};

Task make_task(const MinigolfConfig& config, const Rollout& rollout, double dt) {
  const RowMatrix actions =
      config.strike == Strike::recorded ? rollout.actions : strike_actions(rollout.num_steps(), dt);
  Eigen::Vector2d start(kBallStartX, kBallStartY);
  if (config.ball_start == BallStart::recorded) start = rollout.states.row(0).transpose();
  return {{actions, config.substeps, config.substeps_near}, start};
}

// Values that are finite and no recording has: Bullet would make nonsense of them.
void check_magnitudes(const Target& target) {
  if (!(target.dt >= kMinTimeStep && target.dt <= kMaxTimeStep)) {
    throw InputError(fmt::format("{}: dt = {} s, must be between {} and {} s for 'minigolf'",
                                 target.source, target.dt, kMinTimeStep, kMaxTimeStep));
  }
  for (const Rollout& rollout : target.rollouts) {
    const double largest = rollout.actions.cwiseAbs().maxCoeff();
    if (largest <= kMaxJointAngle) continue;
    throw InputError(fmt::format("rollout '{}': a joint angle of {} rad, must be within {} rad",
                                 rollout.name, largest, kMaxJointAngle));
  }
}

// Receives the ball's place after step t, t = 1, ..., T.
using Sink = std::function<void(Index t, const Eigen::Vector3d& ball)>;

RolloutStatus status_of(const Eigen::Vector3d& ball, const Course& course) {
  if (!ball.allFinite()) return RolloutStatus::diverged;
  const bool is_above = ball.z() > (1.0 - kSunk) * course.ball_radius;
  return is_above && is_on_ground(ball.x(), ball.y()) ? RolloutStatus::ok
                                                      : RolloutStatus::left_scene;
}

RolloutStatus simulate(const MinigolfConfig& config, const Course& course, const Task& task,
                       double dt, const Sink& sink) {
  const Eigen::Vector3d start(task.start.x(), task.start.y(), course.ball_radius);
  const bool is_free = head_gap(task.motion.pose(0, -1, true), start) > course.ball_radius;
  if (!is_free || begins_inside(course, start.x(), start.y())) return RolloutStatus::out_of_limits;
  BallWorld world(config, course, task.motion, dt, task.start);
  const Index steps = task.motion.num_steps();
  Eigen::Vector3d ball = world.ball_position();
  for (Index t = 0; t < steps; ++t) {
    if (!world.has_come_to_rest()) {
      world.step(t);
      ball = world.ball_position();
      const RolloutStatus status = status_of(ball, course);
      if (status != RolloutStatus::ok) return status;
    }
    sink(t + 1, ball);
  }
  return RolloutStatus::ok;
}

}  // namespace

Minigolf::Minigolf(const SimulatorConfig& config) : config_(config), info_(make_info()) {
  check_config(config_);
  replace_nominal(config_.parameters, info_);
}

Trajectories Minigolf::replay(const Target& target, const RowMatrix& theta) const {
  check_num_parameters(theta.cols(), info_);
  check_target(target, info_, config_.store_every);
  check_magnitudes(target);
  std::vector<Task> tasks;
  for (const Rollout& rollout : target.rollouts) {
    tasks.push_back(make_task(config_.minigolf, rollout, target.dt));
  }
  Trajectories result;
  result.resize(theta.rows(), target.num_rollouts(), target.num_steps() / config_.store_every,
                target.num_states());

  parallel_for(theta.rows(), [&](Index i) {
    RolloutStatus& status = result.status[static_cast<std::size_t>(i)];
    if (!is_possible(theta.row(i), info_)) status = RolloutStatus::out_of_limits;
    const Course course = course_at(theta.row(i));
    float* out = result.row(i).data();
    for (std::size_t h = 0; h < tasks.size() && status == RolloutStatus::ok; ++h) {
      const auto keep = [&](Index t, const Eigen::Vector3d& ball) {
        if (t % config_.store_every != 0) return;
        *out++ = static_cast<float>(ball.x());
        *out++ = static_cast<float>(ball.y());
      };
      status = simulate(config_.minigolf, course, tasks[h], target.dt, keep);
    }
    if (status != RolloutStatus::ok) {
      std::ranges::fill(result.row(i), kFloatNaN);
    }
  });
  return result;
}

std::vector<Outline> Minigolf::outlines(const Vector& theta) const {
  std::vector<Outline> outlines;
  for (const CourseBox& box : bounds()) outlines.push_back({corners(box), true});
  outlines.push_back({hole_rim(), true});
  for (const CourseBox& box : course_at(theta.transpose()).obstacles) {
    outlines.push_back({corners(box), false});
  }
  return outlines;
}

Target Minigolf::behave(const Vector& theta, Index num_rollouts, std::uint64_t seed) const {
  Target target = begin_target(theta, num_rollouts, info_);
  const MinigolfConfig& config = config_.minigolf;
  for (Index h = 0; h < num_rollouts; ++h) {
    Stream stream({seed, "behaviour", 0, static_cast<std::uint64_t>(h), 0});
    Rollout rollout{"simulated " + std::to_string(h), RowMatrix(info_.num_steps + 1, 2),
                    strike_actions(info_.num_steps, info_.dt)};
    rollout.states(0, 0) = kBallStartX + kStartSpread * (2.0 * stream.uniform() - 1.0);
    rollout.states(0, 1) = kBallStartY + kStartSpread * (2.0 * stream.uniform() - 1.0);
    const Task task = make_task(config, rollout, info_.dt);
    rollout.states(0, 0) = task.start.x();
    rollout.states(0, 1) = task.start.y();
    const RolloutStatus status = simulate(config, course_at(theta.transpose()), task, info_.dt,
                                          [&](Index t, const Eigen::Vector3d& ball) {
                                            rollout.states.row(t) = ball.head<2>().transpose();
                                          });
    if (status != RolloutStatus::ok) {
      throw Error("the simulated target domain ends as " + std::string(to_string(status)) +
                  "; check its parameters");
    }
    target.rollouts.push_back(std::move(rollout));
  }
  return target;
}

}  // namespace npdr::sim
