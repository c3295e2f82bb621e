#include "sim/minigolf/ball_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/minigolf/arm.h"

namespace npdr::sim {
namespace {

constexpr double kStep = 0.01;
const Eigen::Vector2d kFarAway(-1.0, 1.3);  // on the ground, away from everything

Course course_with(double radius, const Surface& ball, const Surface& ground) {
  Course course;
  course.ball_radius = radius;
  course.ball_mass = 0.005;
  course.ball = ball;
  course.ground = ground;
  course.obstacles = {CourseBox{0.29, 0.015, 0.015, 0.9, 1.45, 0.0},
                      CourseBox{0.29, 0.015, 0.015, 0.6, 1.15, 0.0}};
  return course;
}

// A club that stays where the strike ends.
ClubMotion resting_club(Index num_steps, Index coarse = 2) {
  RowMatrix actions(num_steps, static_cast<Index>(kNumJoints));
  for (Index t = 0; t < num_steps; ++t) std::ranges::copy(strike(1.0), actions.row(t).data());
  return {actions, coarse, 5};
}

ClubMotion striking_club(Index num_steps, Index coarse = 2, Index fine = 5) {
  return {strike_actions(num_steps, kStep), coarse, fine};
}

MinigolfConfig with(double linear_damping, Rolling rolling = Rolling::exact) {
  MinigolfConfig config;
  config.linear_damping = linear_damping;
  config.rolling = rolling;
  return config;
}

// A ball that rolls from the start in the direction of -x.
void roll(BallWorld& world, const Course& course, double speed) {
  world.set_ball({kFarAway.x(), kFarAway.y(), course.ball_radius}, {-speed, 0.0, 0.0},
                 {0.0, -speed / course.ball_radius, 0.0});
}

// A rolling sphere: v(t) = v0 - (5/7) g mu_c / r t with mu_c = mu_roll,ball mu_ground +
// mu_roll,ground mu_ball.
TEST(BallWorld, RollingFrictionIsThatOfTheClosedForm) {
  for (const auto& [radius, rolling] : {std::pair{0.015, Rolling::exact},
                                        {0.025, Rolling::exact},
                                        {0.015, Rolling::engine},
                                        {0.025, Rolling::engine}}) {
    const Course course = course_with(radius, {0.6, 2e-4, 0.5}, {0.4, 1e-4, 0.0});
    const double mu = 2e-4 * 0.4 + 1e-4 * 0.6;
    const ClubMotion club = resting_club(200);
    BallWorld world(with(0.0, rolling), course, club, kStep, kFarAway);
    roll(world, course, 0.5);
    for (Index t = 0; t < 200; ++t) world.step(t);
    const double deceleration = 5.0 / 7.0 * kGravity * mu / radius;
    EXPECT_NEAR(-world.ball_velocity().x(), 0.5 - 2.0 * deceleration, 0.01 * deceleration);
    EXPECT_NEAR(kFarAway.x() - world.ball_position().x(), 1.0 - 2.0 * deceleration, 0.005);
    EXPECT_NEAR(world.ball_position().z(), radius, 1e-5);
    EXPECT_NEAR(world.ball_position().y(), kFarAway.y(), 1e-6);
  }
}

// Linear damping d takes the factor (1 - d)^t of the velocity, friction gives 2/7 of that back from
// the spin: dv/dt = (5/7) ln(1 - d) v.
TEST(BallWorld, DampingIsThatOfTheClosedForm) {
  const Course course = course_with(0.02, {0.6, 0.0, 0.5}, {0.4, 0.0, 0.0});
  const ClubMotion club = resting_club(200);
  for (const Rolling rolling : {Rolling::exact, Rolling::engine}) {
    BallWorld world(with(0.1, rolling), course, club, kStep, kFarAway);
    roll(world, course, 0.5);
    for (Index t = 0; t < 200; ++t) world.step(t);
    EXPECT_NEAR(-world.ball_velocity().x(), 0.5 * std::exp(5.0 / 7.0 * std::log(0.9) * 2.0), 5e-4)
        << name_of(rolling);
  }
}

// Oblique, with a spin about the vertical, damped, with friction, until it rests.
TEST(BallWorld, RollsInClosedFormAsByTheEngine) {
  const Course course = course_with(0.02, {0.6, 5e-4, 0.5}, {0.4, 1e-4, 0.0});
  const ClubMotion club = resting_club(600);
  BallWorld exact(with(0.1, Rolling::exact), course, club, kStep, kFarAway);
  BallWorld engine(with(0.1, Rolling::engine), course, club, kStep, kFarAway);
  for (BallWorld* world : {&exact, &engine}) {
    world->set_ball({kFarAway.x(), kFarAway.y(), 0.02}, {-0.3, 0.2, 0.0}, {-10.0, -15.0, 4.0});
  }
  for (Index t = 0; t < 600; ++t) {
    exact.step(t);
    engine.step(t);
    // The engine's first-order steps of 5 ms: half a step of deceleration, 0.2 mm/s.
    ASSERT_LT((exact.ball_velocity() - engine.ball_velocity()).norm(), 1e-3) << t;
    ASSERT_LT((exact.ball_position() - engine.ball_position()).norm(), 2e-3) << t;
  }
  EXPECT_LT(exact.ball_velocity().norm(), 1e-3);
  EXPECT_EQ(exact.step_counts().rolled, 600);
  EXPECT_EQ(engine.step_counts().rolled, 0);
}

// From where it touches the outer bound (y = 1.68) a ball that leaves it is in closed form at once,
// along it, too; one that comes nearer bounces, and then rolls away, as by the engine alone.
TEST(BallWorld, RollsAwayFromABoundInClosedForm) {
  const Course course = course_with(0.02, {0.6, 1e-4, 0.6}, {0.4, 1e-5, 0.0});
  const ClubMotion club = resting_club(100);
  for (const auto& [gap, v] : {std::pair{0.0, Eigen::Vector2d(0.2, -0.1)},
                               {1e-3, Eigen::Vector2d(0.2, 0.0)},
                               {0.03, Eigen::Vector2d(0.1, 0.2)}}) {
    BallWorld exact(with(0.1, Rolling::exact), course, club, kStep, kFarAway);
    BallWorld engine(with(0.1, Rolling::engine), course, club, kStep, kFarAway);
    for (BallWorld* world : {&exact, &engine}) {
      world->set_ball({0.8, 1.66 - gap, 0.02}, {v.x(), v.y(), 0.0},
                      {-v.y() / 0.02, v.x() / 0.02, 0.0});
    }
    for (Index t = 0; t < 60; ++t) {
      exact.step(t);
      engine.step(t);
      ASSERT_LT((exact.ball_position() - engine.ball_position()).norm(), 3e-3) << gap << ", " << t;
      ASSERT_LT((exact.ball_velocity() - engine.ball_velocity()).norm(), 1e-2) << gap << ", " << t;
    }
    const Index touching = v.y() > 0.0 ? 20 : 0;  // at most: what it takes to roll again
    EXPECT_GE(exact.step_counts().rolled, 60 - touching) << gap;
    if (v.y() > 0.0) {
      EXPECT_LT(exact.ball_velocity().y(), 0.0) << "it has bounced";
      EXPECT_GT(exact.step_counts().fine, 0);
    }
  }
}

// At 100 instants of a step no point is nearer to the head than its clearance says, nor by more
// than what the head moves between two of the poses that it is found from.
TEST(ClubMotion, ClearanceIsALowerBound) {
  const ClubMotion club = striking_club(30);
  for (Index t = 0; t < 29; ++t) {
    const Eigen::Vector3d center = head_pose(strike((double(t) + 0.5) * kStep)).translation();
    for (const Eigen::Vector3d& offset :
         {Eigen::Vector3d(0.03, 0.0, 0.0), Eigen::Vector3d(-0.02, 0.03, 0.0),
          Eigen::Vector3d(0.01, -0.04, 0.02), Eigen::Vector3d(0.0, 0.2, 0.0)}) {
      const Eigen::Vector3d point = center + offset;
      double nearest = 1.0;
      for (Index k = 0; k <= 100; ++k) {
        const Eigen::Isometry3d head = head_pose(
            between(strike(double(t) * kStep), strike(double(t + 1) * kStep), 0.01 * double(k)));
        nearest = std::min(nearest, head_gap(head, point));
      }
      const double clearance = club.clearance(t, point);
      EXPECT_LE(clearance, nearest + 1e-9) << t;
      if (offset.norm() < 0.1) {
        EXPECT_GT(clearance, nearest - 2e-3) << t;
      }
    }
  }
}

// Ground that is too smooth for the ball's rolling friction can't make it roll: it slides.
TEST(BallWorld, SlidesWhereTheGroundCantHoldIt) {
  const Course course = course_with(0.02, {1.0, 0.01, 0.5}, {0.01, 0.01, 0.0});
  const ClubMotion club = resting_club(50);
  BallWorld world(with(0.0), course, club, kStep, kFarAway);
  roll(world, course, 0.5);
  for (Index t = 0; t < 50; ++t) world.step(t);
  // Rolling friction stops the spin, against which sliding friction turns it: near 0.
  EXPECT_LT(world.ball_spin().norm() * 0.02, 0.01);
  EXPECT_NEAR(-world.ball_velocity().x(), 0.5 - 0.01 * kGravity * 0.5, 1e-3);
}

// Without sliding friction a ball keeps its velocity and doesn't begin to spin.
TEST(BallWorld, ABallOnSmoothGroundSlides) {
  const Course course = course_with(0.02, {0.6, 0.0, 0.5}, {0.0, 0.0, 0.0});
  const ClubMotion club = resting_club(100);
  BallWorld world(with(0.0), course, club, kStep, kFarAway);
  world.set_ball({kFarAway.x(), kFarAway.y(), 0.02}, {-0.5, 0.0, 0.0}, Eigen::Vector3d::Zero());
  for (Index t = 0; t < 100; ++t) world.step(t);
  EXPECT_NEAR(world.ball_velocity().x(), -0.5, 1e-9);
  EXPECT_NEAR(world.ball_spin().norm(), 0.0, 1e-9);
}

// A sliding ball begins to roll; its speed is then 5/7 of what it was, whatever the friction.
TEST(BallWorld, ASlidingBallBeginsToRollAtFiveSeventhsOfItsSpeed) {
  const Course course = course_with(0.02, {0.6, 0.0, 0.5}, {0.4, 0.0, 0.0});
  const ClubMotion club = resting_club(100);
  BallWorld world(with(0.0), course, club, kStep, kFarAway);
  world.set_ball({kFarAway.x(), kFarAway.y(), 0.02}, {-0.7, 0.0, 0.0}, Eigen::Vector3d::Zero());
  for (Index t = 0; t < 100; ++t) world.step(t);
  EXPECT_NEAR(world.ball_velocity().x(), -0.5, 0.005);
  EXPECT_NEAR(world.ball_spin().y(), -0.5 / 0.02, 0.25);
}

// Dropped from h above the ground, a ball comes back to e^2 h; steps of 2 ms cost some percent.
TEST(BallWorld, BouncesAsHighAsItsRestitutionSays) {
  for (const double restitution : {0.3, 0.5, 0.8}) {
    const Course course = course_with(0.02, {0.6, 0.0, restitution}, {0.4, 0.0, 1.0});
    const ClubMotion club = resting_club(200, 20);
    BallWorld world(with(0.0), course, club, kStep, kFarAway);
    const double height = 0.3;
    world.set_ball({kFarAway.x(), kFarAway.y(), 0.02 + height}, Eigen::Vector3d::Zero(),
                   Eigen::Vector3d::Zero());
    double highest = 0.0;
    bool has_bounced = false;
    for (Index t = 0; t < 100; ++t) {
      world.step(t);
      if (!has_bounced && world.ball_velocity().z() > 0.0) has_bounced = true;
      if (has_bounced && world.ball_velocity().z() < 0.0) break;
      if (has_bounced) highest = std::max(highest, world.ball_position().z() - 0.02);
    }
    EXPECT_NEAR(highest / (restitution * restitution * height), 1.0, 0.06) << restitution;
  }
}

// The club is infinitely heavy: along the normal n of its face the ball leaves with (1 + e) v_n.
TEST(BallWorld, TheStrikeGivesTheBallTheClubsVelocity) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    const Course course = course_with(0.02, {0.0, 0.0, restitution}, {0.0, 0.0, 0.0});
    const ClubMotion club = striking_club(30, 2, 20);
    BallWorld world(with(0.0), course, club, kStep, {kBallStartX, kBallStartY});
    Index contact = 0;
    for (Index t = 0; t < 15; ++t) {
      world.step(t);
      if (contact == 0 && world.ball_velocity().norm() > 0.1) contact = t;
    }
    const auto tip = [](Index t) -> Eigen::Vector3d {
      return head_pose(strike(double(t) * kStep)).translation();
    };
    const Eigen::Vector3d normal = head_pose(strike(double(contact) * kStep)).linear().col(2);
    const double club_speed = (tip(contact + 1) - tip(contact)).dot(normal) / kStep;
    EXPECT_NEAR(double(contact), 9.0, 1.0);
    EXPECT_NEAR(world.ball_velocity().dot(normal) / ((1.0 + restitution) * club_speed), 1.0, 0.05)
        << restitution;
  }
}

double energy(const BallWorld& world, const Course& course) {
  const double r = course.ball_radius;
  return 0.5 * world.ball_velocity().squaredNorm() + 0.2 * r * r * world.ball_spin().squaredNorm() +
         kGravity * (world.ball_position().z() - r);
}

// Steps begin, ..., end - 1 add no energy, but for `slack` each.
void expect_no_more_energy(BallWorld& world, const Course& course, Index begin, Index end,
                           double slack) {
  double before = energy(world, course);
  for (Index t = begin; t < end; ++t) {
    world.step(t);
    const double now = energy(world, course);
    ASSERT_LE(now, before + slack) << t;
    before = now;
  }
}

// Nothing but the club adds energy, also not where the ball hits obstacles and bounds: but for what
// lifting the ball out of an overlap takes, 50 um at most, a thousandth of the strike's.
TEST(BallWorld, EnergyNeverGrowsOnceTheClubIsDone) {
  for (const double restitution : {0.2, 0.6, 1.0}) {
    const Course course = course_with(0.02, {0.6, 1e-5, restitution}, {0.4, 1e-5, 0.0});
    const ClubMotion club = striking_club(800);
    BallWorld world({}, course, club, kStep, {kBallStartX, kBallStartY});
    for (Index t = 0; t < 61; ++t) world.step(t);
    expect_no_more_energy(world, course, 61, 800, 5e-4);
  }
}

// The hole's friction stops balls within its 5 cm, by sliding on it with mu g = 6 g: v^2 / (2 mu g)
// is 14 mm at 1.3 m/s. Only what enters near the edge is out again before.
TEST(BallWorld, TheHoleStopsBalls) {
  const Course course = course_with(0.02, {0.6, 1e-5, 0.5}, {0.4, 1e-5, 0.0});
  const ClubMotion club = resting_club(100);
  for (const double speed : {0.1, 0.3, 0.6, 1.0, 1.3}) {
    for (const double offset : {0.0, 10.0, -15.0}) {
      BallWorld world({}, course, club, kStep, kFarAway);
      world.set_ball({kHoleX - 0.05, kHoleY + 1e-3 * offset, 0.02}, {speed, 0.0, 0.0},
                     {0.0, speed / 0.02, 0.0});
      SCOPED_TRACE(testing::Message() << speed << " m/s, " << offset << " mm");
      expect_no_more_energy(world, course, 0, 100, 1e-4);
      const Eigen::Vector2d place = world.ball_position().head<2>();
      EXPECT_LT((place - Eigen::Vector2d(kHoleX, kHoleY)).norm(), kHoleRadius + 1e-3);
      EXPECT_LT(world.ball_velocity().norm(), 1e-3);
    }
  }
}

// However the ball spins and slides, rolling friction takes energy and never gives any.
TEST(BallWorld, RollingFrictionNeverAddsEnergy) {
  const Course course = course_with(0.02, {0.6, 0.02, 0.5}, {0.1, 0.02, 0.0});
  const ClubMotion club = resting_club(60);
  for (const double direction : {0.0, 1.0, 2.0, 3.0}) {
    for (const double spin : {-30.0, 1.0, 30.0}) {
      BallWorld world(with(0.0), course, club, kStep, kFarAway);
      world.set_ball({kFarAway.x(), kFarAway.y(), 0.02},
                     {0.5 * std::cos(direction), 0.5 * std::sin(direction), 0.0}, {0.0, spin, 0.0});
      SCOPED_TRACE(testing::Message() << direction << ", " << spin);
      expect_no_more_energy(world, course, 0, 60, 1e-5);
    }
  }
}

TEST(BallWorld, ABallAtRestStaysWhereItIs) {
  const Course course = course_with(0.02, {0.6, 5e-4, 0.1}, {0.4, 1e-5, 0.0});
  const ClubMotion club = striking_club(1600);
  BallWorld world({}, course, club, kStep, {kBallStartX, kBallStartY});
  Index t = 0;
  while (t < 800 && !world.has_come_to_rest()) world.step(t++);
  ASSERT_LT(t, 800);
  ASSERT_GT(t, 50) << "the ball rests before the strike, too, but not for good";
  const Eigen::Vector3d place = world.ball_position();
  for (Index k = 0; k < 200; ++k) world.step(t++);
  EXPECT_LT((world.ball_position() - place).norm(), 1e-4);
}

// A club that was removed from the world and comes back strikes with its own velocity.
TEST(BallWorld, TheClubComesBackWithItsVelocity) {
  const Course course = course_with(0.02, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
  const ClubMotion club = striking_club(30);
  BallWorld world(with(0.0), course, club, kStep, {kBallStartX, kBallStartY});
  world.set_ball({kFarAway.x(), kFarAway.y(), 0.02}, Eigen::Vector3d::Zero(),
                 Eigen::Vector3d::Zero());
  for (Index t = 0; t < 7; ++t) world.step(t);
  world.set_ball({kBallStartX, kBallStartY, 0.02}, Eigen::Vector3d::Zero(),
                 Eigen::Vector3d::Zero());
  for (Index t = 7; t < 15; ++t) world.step(t);
  EXPECT_NEAR(world.ball_velocity().x(), 0.645, 0.05);
}

// So does one that was in the world, waited while the ball rested in closed form elsewhere, and
// touches the ball in the first substep of its return.
TEST(BallWorld, AClubThatWaitedHasTheVelocityOfOneThatJoins) {
  const Course course = course_with(0.02, {0.6, 0.0, 0.0}, {0.4, 0.0, 0.0});
  const ClubMotion club = striking_club(30);
  // On the ground before the club, with a gap of 0.1 mm when step t begins.
  const auto place_before_the_club = [&](BallWorld& world, Index t) {
    Eigen::Vector3d place = club.pose(t, -1, true).translation();
    place.z() = 0.02;
    while (head_gap(club.pose(t, -1, true), place) < 0.0201) place.x() += 1e-4;
    world.set_ball(place, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  };
  BallWorld joined(with(0.0), course, club, kStep, kFarAway);
  BallWorld waited(with(0.0), course, club, kStep, kFarAway);
  place_before_the_club(waited, 0);
  for (Index t = 0; t < 10; ++t) {
    if (t == 1) waited.set_ball(joined.ball_position(), Eigen::Vector3d::Zero(), {0.0, 0.0, 0.0});
    if (t == 7) {
      place_before_the_club(waited, t);
      place_before_the_club(joined, t);
    }
    joined.step(t);
    waited.step(t);
  }
  EXPECT_GT(waited.step_counts().rolled, 4);
  EXPECT_GT(joined.ball_velocity().x(), 0.4);
  EXPECT_LT((waited.ball_velocity() - joined.ball_velocity()).norm(), 1e-6);
}

}  // namespace
}  // namespace npdr::sim
