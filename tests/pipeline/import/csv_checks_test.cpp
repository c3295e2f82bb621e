// What an import finds wrong with angles, rates and single samples.
#include <fmt/format.h>

#include <cmath>

#include "tests/pipeline/import/csv_files.h"

namespace npdr::pipeline {
namespace {

class CsvChecks : public CsvFiles {};

// A pendulum that goes round with this rate [rad/s], its angle as a device gives it.
std::string turning_csv(double rate, double factor = 1.0, double rate_factor = 1.0) {
  std::string text = "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n";
  for (int i = 0; i < 200; ++i) {
    const double angle = std::remainder(rate * 0.01 * i, 2.0 * M_PI);
    text += fmt::format("{:.2f},{:.6f},{:.6f},0\n", 0.01 * i, factor * angle, rate_factor * rate);
  }
  return text;
}

TEST_F(CsvChecks, AnglesMayNotWrap) {
  CsvOptions options = pendulum_options();
  const std::string found = problem(turning_csv(10.0));
  EXPECT_TRUE(says(found, {"a.csv:34: theta jumps by -6.183 after the line before",
                           "3 such jumps in 1 file", "--unwrap theta\n", "--no-rate-check"}));
  EXPECT_TRUE(says(problem(turning_csv(10.0, 180.0 / M_PI)),
                   {"a.csv:34: theta jumps by -354.3", "degrees", "[rad]",
                    "--scale theta=0.0174533 --unwrap theta\n", "theta changes 57.3 times",
                    "--scale theta=0.0174533", "\n--no-rate-check"}));
  options.unwrap = {"theta"};
  const Target target = imported(turning_csv(10.0), options);
  EXPECT_NEAR(target.rollouts[0].states(199, 0), 19.9, 1e-5);
  EXPECT_TRUE(says(notes(turning_csv(10.0), options).at(0), {"unwrapped theta: 3 jumps"}));
  options = pendulum_options();
  options.check_rates = false;
  EXPECT_LT(imported(turning_csv(10.0), options).rollouts[0].states(199, 0), M_PI);
}

// All of a swing in degrees, its rate too, contradicts nothing but its unit.
TEST_F(CsvChecks, WarnsOfAnglesThatBeginBeyondATurn) {
  const auto swing = [](double factor) {
    std::string text = "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n";
    for (int i = 0; i < 200; ++i) {
      const double t = 0.01 * i;
      text += fmt::format("{:.2f},{:.6f},{:.6f},0\n", t, factor * 0.3 * std::cos(5.0 * t),
                          factor * -1.5 * std::sin(5.0 * t));
    }
    return text;
  };
  EXPECT_EQ(notes(swing(1.0), pendulum_options()).size(), 1u);
  EXPECT_TRUE(says(notes(swing(180.0 / M_PI), pendulum_options()).at(1),
                   {"warning: ", "a.csv: theta begins at 17.2 rad", "if it is in degrees",
                    "--scale theta=0.0174533"}));
}

TEST_F(CsvChecks, WarnsOfGlitches) {
  const auto swing = [](double glitch) {
    std::string text = "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n";
    for (int i = 0; i < 200; ++i) {
      const double t = 0.01 * i, theta = i == 57 ? glitch : 0.3 * std::cos(5.0 * t);
      text += fmt::format("{:.2f},{:.6f},{:.6f},0\n", t, theta, -1.5 * std::sin(5.0 * t));
    }
    return text;
  };
  CsvOptions options = pendulum_options();
  EXPECT_TRUE(says(notes(swing(2.0), options).at(0),
                   {"warning: ", "a.csv:59: theta = 2 alone, between -0.2827 and",
                    "largest magnitude: leave its row out and add --resample DT"}));
  EXPECT_TRUE(says(notes(swing(-999.0), options).at(0), {"warning: ", "a.csv:59: theta = -999"}));
  // Looks like a jump of a turn, too.
  EXPECT_TRUE(says(problem(swing(6.0), options),
                   {"a.csv:59: theta = 6 alone", "\na.csv:59: theta jumps by 6.283",
                    "--unwrap theta", "\n--no-rate-check"}));
  options.check_rates = false;
  options.resample = 0.02;
  EXPECT_TRUE(says(notes(swing(2.0), options).at(0),
                   {"warning: ", "a.csv:59: theta = 2 alone", "magnitude: leave its row out"}));
}

// A swing that an encoder recorded, which stood still from sample 40 to 39 + `still`.
std::string swing_csv(Index still, double dt, const std::string& header, double rate = 0.0) {
  std::string text = header;
  for (Index i = 0; i < 200; ++i) {
    const double t = 0.01 * static_cast<double>(i >= 40 && i < 40 + still ? 40 : i);
    text += fmt::format("{:.3f},{:.6f}", dt * static_cast<double>(i), 0.3 * std::cos(5.0 * t));
    if (rate != 0.0) text += fmt::format(",{:.6f}", -rate * std::sin(5.0 * t));
    text += "\n";
  }
  return text;
}

TEST_F(CsvChecks, WarnsOfLeaps) {
  const CsvOptions options{.channels = {{{"q", "m"}}, {}}, .dt = {}, .source = ""};
  const std::string header = "t [s],q [m]\n";
  const auto of_none = notes(swing_csv(0, 0.01, header), options);
  ASSERT_EQ(of_none.size(), 1u) << join(of_none);
  EXPECT_TRUE(says(of_none.at(0), {"not checked: units, signs and the order of columns"}));
  EXPECT_TRUE(says(notes(swing_csv(30, 0.01, header), options).at(0),
                   {"warning: ", "a.csv: q leaps by",
                    "in the step after 0.69 s, after 30 samples "
                    "that are the same",
                    "did the sensor stand still?"}));
}

// Over so much of a recording that is right the rate agrees.
TEST_F(CsvChecks, WarnsOfLeapsBesideMeasuredRates) {
  const CsvOptions options{.channels = {{{"q", "m"}, {"v", "m/s"}}, {}}, .dt = {}, .source = ""};
  const auto said = notes(swing_csv(20, 0.01, "t [s],q [m],v [m/s]\n", 1.5), options);
  EXPECT_NE(join(said).find("a.csv: q leaps by"), std::string::npos) << join(said);
}

TEST_F(CsvChecks, WarnsOfSlowClocks) {
  CsvOptions options = pendulum_options();
  options.channels.actions.clear();
  options.differentiate = 5;
  const std::string header = "t [s],theta [rad]\n";
  EXPECT_EQ(join(notes(swing_csv(0, 0.01, header), options)).find("warning"), std::string::npos);
  EXPECT_TRUE(
      says(notes(swing_csv(0, 10.0, header), options).at(1),
           {"warning: ", "a.csv: steps of 10 s", "if times are in ms, add --scale t=0.001"}));
}

// Nobody has said that v is the rate of q.
TEST_F(CsvChecks, WarnsOfLikelyRates) {
  const CsvOptions options{.channels = {{{"q", "m"}, {"v", "m/s"}}, {}}, .dt = {}, .source = ""};
  const std::string header = "t [s],q [m],v [m/s]\n";
  EXPECT_TRUE(says(notes(swing_csv(0, 0.01, header, 1.5), options).at(0),
                   {"checked: v is the slope of q"}));
  EXPECT_TRUE(says(notes(swing_csv(0, 0.01, header, 3.0), options).at(0),
                   {"warning: q changes 0.5 times as fast as v says"}));
}

TEST_F(CsvChecks, UnwrapsAnglesOnly) {
  CsvOptions options = pendulum_options();
  options.unwrap = {"thet"};
  EXPECT_TRUE(says(problem(kCsv, options), {"--unwrap: unknown state 'thet'", "'theta'"}));
  options.unwrap = {"theta_dot"};
  EXPECT_TRUE(says(problem(kCsv, options),
                   {"--unwrap theta_dot: it is in [rad/s]", "must be in [rad] or [deg]"}));
}

TEST_F(CsvChecks, RatesMustBeSlopes) {
  CsvOptions options = pendulum_options();
  options.unwrap = {"theta"};
  EXPECT_TRUE(says(notes(turning_csv(5.0), options).at(1),
                   {"checked: theta_dot is the slope of theta", "%"}));
  EXPECT_TRUE(says(problem(turning_csv(5.0, 1.0, 2.0), options),
                   {"theta changes 0.5 times as fast as theta_dot says", "dt is probably",
                    "--scale t=0.5", "--scale theta_dot=0.5", "\n--no-rate-check"}));
  options.check_rates = false;
  EXPECT_EQ(imported(turning_csv(5.0, 1.0, 2.0), options).num_steps(), 199);
}

}  // namespace
}  // namespace npdr::pipeline
