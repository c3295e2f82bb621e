// Models of MuJoCo as libraries; skipped where npdr was built without MuJoCo.
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sim/library/library_simulator.h"
#include "sim/simulator.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr::sim {
namespace {

// A pendulum of 1 m and 2 kg, all of it at its end.
constexpr const char* kPendulum = R"(
<mujoco model="pendulum">
  <option timestep="0.001" integrator="RK4" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="pole">
      <joint name="q" type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 -1" mass="2" diaginertia="1e-8 1e-8 1e-8"/>
      <geom name="tip" type="sphere" size="0.05" pos="0 0 -1" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <actuator><motor name="torque" joint="q"/></actuator>
  <sensor><jointpos name="encoder" joint="q"/></sensor>
</mujoco>
)";

// A rod of 1 m and 1 kg about its end, and `more` on it.
std::string rod(const std::string& more = "") {
  return R"(
<mujoco>
  <option timestep="0.001" integrator="RK4" gravity="0 0 -9.81"/>
  <worldbody>
    <body name="pole">
      <joint name="q" type="hinge" axis="0 1 0"/>
      <geom name="rod" type="box" size="1e-3 1e-3 0.5" pos="0 0 -0.5" mass="1"/>)" +
         more + R"(
    </body>
  </worldbody>
</mujoco>)";
}

class MujocoModels : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(library())) GTEST_SKIP() << "npdr was built without MuJoCo";
  }
  static std::filesystem::path library() { return NPDR_BINARY_DIR "/lib/npdr_mujoco.so"; }

  LibraryConfig config(const std::string& parameters, const std::string& states = "",
                       const std::string& xml = kPendulum) {
    const auto model = folder_.file("model.xml", xml);
    return {library(), R"({"model": ")" + model.string() + R"(", "parameters": [)" + parameters +
                           R"(], "states": [)" + states + R"(], "actions": []})"};
  }

  std::string problem(const std::string& parameters, const std::string& states = "",
                      const std::string& xml = kPendulum) {
    const std::string text =
        message_of<InputError>([&] { LibrarySimulator(config(parameters, states, xml)); });
    return text.substr(std::min(text.size(), text.find(".so: ") + 5));
  }

  // One rollout from (q, q_dot) with a torque in each step.
  static Target target(double q, const Vector& torque, double dt = 0.01) {
    Target target;
    target.dt = dt;
    target.state_channels = {{"q", "rad"}, {"q_dot", "rad/s"}};
    target.action_channels = {{"torque", "1"}};
    Rollout rollout{"0", RowMatrix::Zero(torque.size() + 1, 2), RowMatrix(torque)};
    rollout.states(0, 0) = q;
    target.rollouts = {rollout};
    return target;
  }

  // A swing of a model without actuators.
  static Target free_swing() {
    Target free = target(0.01, Vector::Zero(100));
    free.action_channels.clear();
    free.rollouts[0].actions.resize(100, 0);
    return free;
  }
  static Trajectories replay(const LibrarySimulator& simulator, const Target& target,
                             const RowMatrix& theta, Index segment_length = 0) {
    const std::vector<std::uint32_t> seeds(static_cast<std::size_t>(theta.rows()), 0);
    return simulator.replay(cut(target, segment_length), 1, theta, seeds);
  }

  TempFolder folder_;
};

TEST_F(MujocoModels, DescribeWhatTheStudyAsksFor) {
  const LibrarySimulator simulator(
      config(R"("body.pole.mass", "joint.q.damping", "option.gravity", "actuator.torque.delay")"));
  const SimulatorInfo& info = simulator.info();
  EXPECT_EQ(info.name, "pendulum");
  EXPECT_EQ(info.state_channels, (std::vector<Channel>{{"q", "rad"}, {"q_dot", "rad/s"}}));
  EXPECT_EQ(info.action_channels, (std::vector<Channel>{{"torque", "1"}}));
  ASSERT_EQ(info.parameters.size(), 4u);
  EXPECT_EQ(info.parameters[0].nominal, 2.0);
  EXPECT_EQ(info.parameters[0].unit, "kg");
  EXPECT_GT(info.parameters[0].lower, 0.0) << "masses stay positive";
  EXPECT_EQ(info.parameters[1].unit, "N m s/rad");
  EXPECT_EQ(info.parameters[2].nominal, 9.81);
  EXPECT_EQ(info.parameters[3].nominal, 0.0);
  EXPECT_NE(simulator.fingerprint(), "");
}

// Small swings of a pendulum under gravity g have the frequency sqrt(g / 1 m).
TEST_F(MujocoModels, SwingAsFastAsGravitySays) {
  const LibrarySimulator simulator(config(R"("option.gravity")"));
  const Trajectories x =
      replay(simulator, target(0.01, Vector::Zero(100)), (RowMatrix(2, 1) << 9.81, 4.0).finished());
  for (Index i = 0; i < 2; ++i) {
    const double omega = std::sqrt(i == 0 ? 9.81 : 4.0);
    // q^2 / 16 of the frequency, over a second: below 1e-7 rad.
    for (Index t = 0; t < 100; ++t) {
      EXPECT_NEAR(x.rollout(i, 0)(t, 0), 0.01 * std::cos(omega * 0.01 * static_cast<double>(t + 1)),
                  2e-7);
    }
  }
}

TEST_F(MujocoModels, RowsDoNotKnowEachOther) {
  const LibrarySimulator simulator(
      config(R"("option.gravity", "body.pole.mass", "joint.q.armature", "joint.q.frictionloss")"));
  const Target pushed = target(0.4, Vector::Constant(50, 1.5));
  RowMatrix theta(3, 4);
  theta << 9.0, 1.0, 0.1, 0.2, 10.0, 2.5, 0.0, 0.0, 9.0, 1.0, 0.1, 0.2;
  const Trajectories all = replay(simulator, pushed, theta);
  EXPECT_TRUE(std::ranges::equal(all.row(0), all.row(2)));
  EXPECT_FALSE(std::ranges::equal(all.row(0), all.row(1)));
  EXPECT_TRUE(std::ranges::equal(replay(simulator, pushed, theta.row(1)).row(0), all.row(1)));
}

// theta_ddot of a pendulum at rest that hangs down, pushed by tau, is tau / (m l^2) at first.
TEST_F(MujocoModels, DelayCountsStepsOfTheRecordingAcrossSegments) {
  const LibrarySimulator simulator(config(R"("actuator.torque.delay")"));
  Vector torque = Vector::Zero(8);
  torque(2) = 2.0;  // acts during step 2, and with a delay of d during steps 2 + d to 3 + d
  const RowMatrix delays = (RowMatrix(3, 1) << 0.0, 1.0, 1.5).finished();
  for (const Index segment_length : {0, 3}) {
    const Trajectories x = replay(simulator, target(0.0, torque), delays, segment_length);
    const auto speed = [&](Index row, Index t) { return x.rollout(row, 0)(t, 1); };
    EXPECT_EQ(speed(0, 1), 0.0f);
    EXPECT_NEAR(speed(0, 2), 0.01, 1e-5);
    EXPECT_EQ(speed(1, 2), 0.0f);
    EXPECT_NEAR(speed(1, 3), 0.01, 1e-5) << "the torque of before the segment began";
    EXPECT_EQ(speed(2, 2), 0.0f);
    EXPECT_NEAR(speed(2, 3), 0.005, 1e-5);
    EXPECT_NEAR(speed(2, 4) - speed(2, 3), segment_length == 0 ? 0.005 : 0.005, 2e-5);
  }
}

TEST_F(MujocoModels, SensorsAreChannels) {
  const LibrarySimulator simulator(
      config(R"("option.gravity")", R"("q [rad]", "q_dot", "encoder [rad]")"));
  Target target = MujocoModels::target(0.3, Vector::Zero(20));
  target.state_channels.push_back({"encoder", "rad"});
  target.rollouts[0].states.conservativeResize(Eigen::NoChange, 3);
  const Trajectories x = replay(simulator, target, RowMatrix::Constant(1, 1, 9.81));
  for (Index t = 0; t < 20; ++t) EXPECT_EQ(x.rollout(0, 0)(t, 0), x.rollout(0, 0)(t, 2));
}

TEST_F(MujocoModels, SegmentsBeginWhereASensorOfAJointWas) {
  const LibrarySimulator joint(config(R"("option.gravity")", R"("q")"));
  const LibrarySimulator sensor(config(R"("option.gravity")", R"("encoder [rad]")"));
  Target target = MujocoModels::target(0.3, Vector::Zero(20));
  target.state_channels = {{"q", "rad"}};
  target.rollouts[0].states = target.rollouts[0].states.leftCols(1).eval();
  const RowMatrix gravity = RowMatrix::Constant(1, 1, 9.81);
  const Trajectories expected = replay(joint, target, gravity);
  target.state_channels = {{"encoder", "rad"}};
  EXPECT_TRUE(std::ranges::equal(replay(sensor, target, gravity).row(0), expected.row(0)));
  const LibrarySimulator velocity(config(R"("option.gravity")", R"("q_dot")"));
  EXPECT_TRUE(has(velocity.info().description, "aren't recorded: q"));
}

// A body's inertia is that of its geometry, of whatever size, scaled to its mass: a rod of length l
// about its end swings with omega^2 = 3 g / (2 l).
TEST_F(MujocoModels, MassesOfBodiesGoWithSizesOfTheirGeoms) {
  const LibrarySimulator simulator(config(R"("geom.rod.size3", "body.pole.mass")", "", rod()));
  const RowMatrix theta = (RowMatrix(3, 2) << 0.5, 1.0, 0.2, 1.0, 0.2, 7.0).finished();
  const Trajectories x = replay(simulator, free_swing(), theta);
  for (Index i = 0; i < 3; ++i) {
    const double half = theta(i, 0);  // its center stays at 0.5 m
    const double omega = std::sqrt(9.81 * 0.5 / (half * half / 3.0 + 0.25));
    EXPECT_NEAR(x.rollout(i, 0)(99, 0), 0.01 * std::cos(omega), 3e-7) << i;
  }
}

// The mass of a geom is a compiler's business: the body's inertia follows. A rod of mass m and
// length 1 m about its end swings as if it were 2/3 m long, whatever it weighs; with a mass M at
// its end omega^2 = g (m / 2 + M) / (m / 3 + M).
TEST_F(MujocoModels, MassesOfGeomsBecomeInertiasOfBodies) {
  const std::string weight =
      R"(<geom name="tip" type="box" size="1e-3 1e-3 1e-3" pos="0 0 -1" density="1e8"/>)";
  const LibrarySimulator simulator(config(R"("geom.rod.mass", "geom.tip.mass")", "", rod(weight)));
  EXPECT_EQ(simulator.info().parameters[0].nominal, 1.0);
  EXPECT_NEAR(simulator.info().parameters[1].nominal, 0.8, 1e-9) << "of its density";
  const RowMatrix theta = (RowMatrix(3, 2) << 1.0, 1e-9, 5.0, 1e-9, 1.0, 3.0).finished();
  const Trajectories x = replay(simulator, free_swing(), theta);
  for (Index i = 0; i < 3; ++i) {
    const double rod = theta(i, 0), tip = theta(i, 1);
    const double omega = std::sqrt(9.81 * (rod / 2.0 + tip) / (rod / 3.0 + tip));
    EXPECT_NEAR(x.rollout(i, 0)(99, 0), 0.01 * std::cos(omega), 3e-7) << i;
  }
}

TEST_F(MujocoModels, MistakesAreNamed) {
  EXPECT_TRUE(
      says(problem(R"("geom.pole.mass")"), {"open() failed", "no geom called 'pole'", "tip"}));
  EXPECT_TRUE(says(problem(R"("body.pole.color")"),
                   {"open() failed", "unknown attribute 'color'", "mass"}));
  EXPECT_TRUE(says(problem(R"("mass")"), {"open() failed", "'mass'", "ELEMENT.NAME.ATTRIBUTE"}));
  EXPECT_TRUE(says(problem(R"("wheel.a.mass")"), {"open() failed", "must begin with option"}));
  EXPECT_TRUE(
      says(problem(R"("geom.tip.mass")"), {"open() failed", "<inertial>", "body.NAME.mass"}));
  EXPECT_TRUE(says(problem("", R"("p")"), {"open() failed", "no state 'p'", "q", "encoder"}));
  EXPECT_TRUE(problem("", "", "<mujoco").starts_with("open() failed: MuJoCo can't read it"));
  const LibrarySimulator simulator(config(""));
  EXPECT_TRUE(message_of<InputError>([&] {
                replay(simulator, target(0.0, Vector::Zero(5), 0.0105), RowMatrix(1, 0));
              }).find("isn't a multiple") != std::string::npos);
}

// The Furuta pendulum of the examples against the built-in one: the same equations, the same method
// of Runge and Kutta. What lies between them is the model's inertia of 1e-9 kg m^2 about axes that
// the equations neglect, which five seconds of chaotic motion make larger; a finer step changes
// nothing in it.
TEST_F(MujocoModels, FurutaPendulumIsTheBuiltInOne) {
  const std::string model = NPDR_SOURCE_DIR "/experiments/external/furuta/furuta.xml";
  const LibrarySimulator simulator({library(), R"({"model": ")" + model +
                                                   R"(", "parameters": ["option.timestep"],
                                                   "states": [], "actions": ["voltage [V]"]})"});
  for (const Index substeps : {1, 8}) {
    const auto built_in = make_simulator({.name = "furuta", .substeps = substeps});
    const Vector nominal = complete_theta(*built_in, {});
    const Target target = built_in->behave(nominal, 2, 3);
    const Trajectories mine = built_in->replay(target, nominal.transpose());
    const double timestep = target.dt / static_cast<double>(substeps);
    const Trajectories theirs = replay(simulator, target, RowMatrix::Constant(1, 1, timestep));
    ASSERT_EQ(mine.values.size(), theirs.values.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < mine.values.size(); ++i) {
      largest = std::max(largest, static_cast<double>(std::abs(mine.values[i] - theirs.values[i])));
    }
    EXPECT_LT(largest, 2e-3) << substeps;
    RecordProperty("largest_difference_" + std::to_string(substeps), std::to_string(largest));
  }
}

}  // namespace
}  // namespace npdr::sim
