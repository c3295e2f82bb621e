#include "sim/simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "core/error.h"
#include "tests/message_of.h"

namespace npdr::sim {
namespace {

std::string problem_of(const SimulatorConfig& config) {
  return message_of<InputError>([&] { make_simulator(config); });
}

TEST(Simulator, EveryNameMakesASimulatorOfThisName) {
  EXPECT_EQ(simulator_names(), (std::vector<std::string>{"furuta", "minigolf", "pendulum"}));
  for (const std::string& name : simulator_names()) {
    const auto simulator = make_simulator({.name = name});
    EXPECT_EQ(simulator->info().name, name);
    for (const Parameter& p : simulator->info().parameters) {
      EXPECT_LE(p.lower, p.nominal) << p.name;
      EXPECT_LE(p.nominal, p.upper) << p.name;
      EXPECT_FALSE(p.unit.empty()) << p.name;
    }
  }
}

TEST(Simulator, EveryIntegratorSimulatesATarget) {
  for (const auto& [integrator, name, _] : enum_table(Integrator{})) {
    const auto simulator = make_simulator({.name = "pendulum", .integrator = integrator});
    const Target target = simulator->behave(complete_theta(*simulator, {}), 1, 1);
    EXPECT_NO_THROW(target.check("behavior")) << name;
    EXPECT_EQ(target.num_steps(), 400);
    EXPECT_EQ(target.dt, 0.02);
  }
}

TEST(Simulator, BehaviorHasTheRolloutsThatWereAskedFor) {
  const auto simulator = make_simulator({.name = "furuta"});
  const Target target = simulator->behave(complete_theta(*simulator, {}), 3, 1);
  EXPECT_EQ(target.num_rollouts(), 3);
  EXPECT_EQ(target.num_steps(), 1250);
  EXPECT_EQ(target.state_channels, simulator->info().state_channels);
  EXPECT_NE(target.rollouts[0].states, target.rollouts[1].states);
  EXPECT_THROW(simulator->behave(complete_theta(*simulator, {}), 0, 1), InputError);
}

TEST(Simulator, BehaviorThatDivergesIsAnError) {
  const auto simulator = make_simulator({.name = "furuta"});
  const Vector theta = complete_theta(*simulator, {{"motor_constant", 1e4}});
  EXPECT_THROW(simulator->behave(theta, 1, 1), Error);
}

TEST(Simulator, ParametersOfTheConfigReplaceNominalOnes) {
  const auto simulator =
      make_simulator({.name = "pendulum", .parameters = {{"pole_length", 1.25}}});
  const Vector theta = complete_theta(*simulator, {{"pole_mass", 0.5}});
  EXPECT_EQ(theta, (Vector{{0.5, 1.25, 9.81, 0.0}}));
}

TEST(Simulator, ParametersThatAreImpossibleFailTheirRow) {
  const auto simulator = make_simulator({.name = "pendulum"});
  const Vector nominal = complete_theta(*simulator, {});
  const Target target = simulator->behave(nominal, 1, 1);
  RowMatrix theta = nominal.transpose().replicate(3, 1);
  theta(1, parameter_index(simulator->info(), "damping")) = -1e-9;
  theta(2, parameter_index(simulator->info(), "damping")) = 100.0;
  const Trajectories result = simulator->replay(target, theta);
  EXPECT_EQ(result.status[0], RolloutStatus::ok);
  EXPECT_EQ(result.status[1], RolloutStatus::out_of_limits);
  EXPECT_TRUE(std::ranges::all_of(result.row(1), [](float x) { return std::isnan(x); }));
  EXPECT_EQ(result.rollout(0, 0), simulator->replay(target, nominal.transpose()).rollout(0, 0));
  EXPECT_NE(result.status[2], RolloutStatus::out_of_limits) << "a limit is possible";
}

TEST(Simulator, RejectsAConfigThatIsOutOfRange) {
  EXPECT_TRUE(
      has(problem_of({.name = "furta"}), "unknown simulator 'furta' (did you mean 'furuta'?)"));
  EXPECT_TRUE(has(problem_of({.name = "furuta", .segment_length = -1}),
                  "simulator.segment_length = -1, must be >= 0"));
  EXPECT_TRUE(
      has(problem_of({.name = "furuta", .substeps = 0}), "simulator.substeps = 0, must be >= 1"));
  EXPECT_TRUE(has(problem_of({.name = "furuta", .integrator = Integrator::cvode, .substeps = 4}),
                  "simulator.substeps = 4, must be 1 with integrator 'cvode'"));
  EXPECT_TRUE(has(problem_of({.name = "furuta", .store_every = 0}),
                  "simulator.store_every = 0, must be >= 1"));
  EXPECT_TRUE(has(problem_of({.name = "furuta", .parameters = {{"pole_lenght", 0.1}}}),
                  "did you mean 'pole_length'?"));
  EXPECT_TRUE(has(problem_of({.name = "furuta", .parameters = {{"pole_mass", -0.1}}}),
                  "simulator.parameters.pole_mass = -0.1, must be in [0.0001, 10] kg"));
}

TEST(Simulator, ParametersHaveTheirPositionInTheta) {
  const auto simulator = make_simulator({.name = "furuta"});
  EXPECT_EQ(parameter_index(simulator->info(), "rotary_damping"), 0);
  EXPECT_EQ(parameter_index(simulator->info(), "gravity"), 8);
  EXPECT_EQ(parameter_index(simulator->info(), "cable_rest_angle"), 14);
}

TEST(Simulator, CompleteThetaNamesTheNearestParameter) {
  const auto simulator = make_simulator({.name = "pendulum"});
  EXPECT_TRUE(has(message_of<InputError>([&] {
                    complete_theta(*simulator, {{"pole_mas", 1.0}});
                  }),
                  "unknown pendulum parameter 'pole_mas' (did you mean 'pole_mass'?)"));
}

TEST(Simulator, RejectsATargetWithOtherChannels) {
  const auto simulator = make_simulator({.name = "pendulum"});
  const RowMatrix theta = complete_theta(*simulator, {}).transpose();
  const Target target = simulator->behave(theta.transpose(), 1, 1);
  const auto message = [&](const std::function<void(Target&)>& change) {
    Target changed = target;
    change(changed);
    return message_of<InputError>([&] { simulator->replay(changed, theta); });
  };
  EXPECT_EQ(message([](Target&) {}), "");
  EXPECT_TRUE(
      has(message([](Target& t) { t.state_channels[1].label = "omega"; }),
          "target has the state channels 'theta' [rad], 'omega' [rad/s]; simulator 'pendulum' "
          "expects 'theta' [rad], 'theta_dot' [rad/s]"));
  EXPECT_TRUE(has(message([](Target& t) { t.state_channels[0].unit = "deg"; }), "'theta' [deg]"));
  EXPECT_TRUE(has(message([](Target& t) { t.action_channels[0].unit = "mN m"; }),
                  "target has the action channels 'torque' [mN m]"));
  EXPECT_TRUE(has(message([](Target& t) { t.dt = 0.0; }), "dt = 0"));
}

TEST(Simulator, RejectsMoreStepsBetweenStoredStatesThanThereAre) {
  const auto simulator = make_simulator({.name = "pendulum", .store_every = 401});
  const Vector theta = complete_theta(*simulator, {});
  const Target target = simulator->behave(theta, 1, 1);
  EXPECT_TRUE(has(message_of<InputError>([&] { simulator->replay(target, theta.transpose()); }),
                  "simulator.store_every = 401, must be <= 400"));
}

TEST(Simulator, RejectsAThetaOfAnotherWidth) {
  const auto simulator = make_simulator({.name = "pendulum"});
  const Target target = simulator->behave(complete_theta(*simulator, {}), 1, 1);
  EXPECT_THROW(simulator->replay(target, RowMatrix::Ones(2, 3)), ShapeError);
  EXPECT_THROW(simulator->behave(Vector::Ones(5), 1, 1), ShapeError);
}

}  // namespace
}  // namespace npdr::sim
