/// Which column is the clock of a CSV file, and how far clocks may be apart.
#include <fmt/format.h>

#include "tests/pipeline/import/csv_files.h"

namespace npdr::pipeline {
namespace {

class CsvClock : public CsvFiles {
 protected:
  CsvOptions with_dt(double dt) const {
    CsvOptions options = pendulum_options();
    options.dt = dt;
    return options;
  }
};

std::string with_clock(const std::string& name) { return replaced(kCsv, "t [s]", name); }

// theta = t^2 / 2 at n states, `dt` apart.
std::string falling(int n, double dt) {
  std::string text = "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n";
  for (int i = 0; i < n; ++i) {
    const double t = dt * i;
    text += fmt::format("{:.4f},{:.9f},{:.9f},0\n", t, 0.5 * t * t, t);
  }
  return text;
}

TEST_F(CsvClock, IsNoColumnThatDoesNotIncreaseWhereTheStepIsGiven) {
  const std::string text =
      "cycle_time [s],theta [rad],theta_dot [rad/s],torque [N m]\n"
      "1e-4,0.1,1,5\n1e-4,0.2,2,6\n1e-4,0.3,3,7\n";
  EXPECT_EQ(imported(text, with_dt(0.1)).dt, 0.1);
  EXPECT_NE(problem(text).find("times must be equally spaced"), std::string::npos);
}

TEST_F(CsvClock, IsNoColumnThatIsAChannel) {
  CsvOptions options = with_dt(0.1);
  options.channels.actions = {{"t", "N m"}};
  const std::string text = "theta [rad],theta_dot [rad/s],t [N m]\n0.1,1,5\n0.2,2,6\n0.3,3,7\n";
  EXPECT_EQ(imported(text, options).rollouts[0].actions, (RowMatrix{{5}, {6}}));
}

TEST_F(CsvClock, IsInSecondsByItsScale) {
  CsvOptions options = pendulum_options();
  EXPECT_NE(problem(with_clock("Time [ms]")).find("'Time' is in [ms]: --scale Time=FACTOR"),
            std::string::npos);
  options.scales = {{"Time", 1e-3}};
  EXPECT_DOUBLE_EQ(imported(with_clock("Time [ms]"), options).dt, 1e-4);
}

TEST_F(CsvClock, CandidatesAreNamed) {
  const std::string text =
      "wall_time [s],ros_stamp [s],theta [rad],theta_dot [rad/s],torque [N m]\n"
      "0,0,0.1,1,5\n1,1,0.2,2,6\n";
  EXPECT_TRUE(says(problem(text), {"a.csv:1: no column 't [s]' or 'time [s]'",
                                   "call that one of wall_time, ros_stamp so that is the clock"}));
}

// 4 % of a clock are 4 % of every rate.
TEST_F(CsvClock, HasTheMeanStepThatIsGiven) {
  const std::string text = falling(101, 0.0208);
  EXPECT_TRUE(says(problem(text, with_dt(0.02)),
                   {"a.csv: its times are 0.0208 s apart", "--dt says 0.02 s", "leave out --dt"}));
  EXPECT_EQ(imported(text, with_dt(0.02081)).dt, 0.02081) << "to 0.1 %";
  EXPECT_EQ(imported("t [s],theta [rad],theta_dot [rad/s],torque [N m]\n"
                     "0.0,0.1,1,5\n0.33,0.2,2,6\n0.67,0.3,3,7\n1.0,0.4,4,8\n",
                     with_dt(1.0 / 3.0))
                .dt,
            1.0 / 3.0)
      << "rounded times";
}

TEST_F(CsvClock, IsTheSameInAllFiles) {
  const std::string other = falling(101, 0.0208);
  const auto import_both = [&] {
    import_csv({folder_.file("a.csv", falling(101, 0.02)), folder_.file("b.csv", other)},
               pendulum_options());
  };
  EXPECT_TRUE(says(message_of<InputError>(import_both, &folder_),
                   {"b.csv: its times are 0.0208 s apart", "first file 0.02 s"}));
  const auto import_milliseconds = [&] {
    import_csv(
        {folder_.file("a.csv", falling(101, 0.02)), folder_.file("b.csv", falling(101, 20.0))},
        pendulum_options());
  };
  EXPECT_TRUE(says(message_of<InputError>(import_milliseconds, &folder_),
                   {"b.csv: its times are 20 s apart", "first file 0.02 s",
                    "probably in another unit (ms, us)"}));
}

}  // namespace
}  // namespace npdr::pipeline
