#include "sim/savitzky_golay.h"

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "tests/message_of.h"

namespace npdr::sim {
namespace {

// Slopes of a polynomial with these coefficients, by samples dt apart.
Vector slopes_of(const std::vector<double>& coefficients, Index count, Index window, double dt) {
  Vector x(count);
  for (Index t = 0; t < count; ++t) {
    x(t) = 0.0;
    double power = 1.0;
    for (const double c : coefficients) {
      x(t) += c * power;
      power *= static_cast<double>(t) * dt;
    }
  }
  return slopes(x, window, dt);
}

TEST(Slopes, AreExactForQuadraticsUpToBothEnds) {
  constexpr double dt = 0.1;
  const Vector found = slopes_of({2.0, -3.0, 5.0}, 12, 5, dt);
  for (Index t = 0; t < 12; ++t) {
    EXPECT_NEAR(found(t), -3.0 + 10.0 * static_cast<double>(t) * dt, 1e-10) << t;
  }
}

TEST(Slopes, AreExactForCubicsInBetween) {
  constexpr double dt = 0.1;
  const Vector found = slopes_of({2.0, -3.0, 5.0, -7.0}, 12, 5, dt);
  for (Index t = 2; t < 10; ++t) {
    const double time = static_cast<double>(t) * dt;
    EXPECT_NEAR(found(t), -3.0 + 10.0 * time - 21.0 * time * time, 1e-9) << t;
  }
}

TEST(Slopes, OneWindowIsEnough) { EXPECT_NEAR(slopes_of({0.0, 4.0}, 5, 5, 0.5)(4), 4.0, 1e-12); }

// Statement of docs/file-formats.md on the window of 11 samples at 250 Hz: a swing of 2 Hz loses
// less than 0.1 %, and rounding to 2048 counts a turn gives noise of less than 0.06 rad/s. The
// error of rounding is spread evenly over a count; 4 % is three standard errors of a deviation of
// 4000 values that each depend on their neighbors, so 0.0545 rad/s stays below.
TEST(Slopes, TheWindowOfRecordingsFollowsSwingsAndSmoothsEncoders) {
  constexpr double dt = 0.004, omega = 4.0 * M_PI, count = 2.0 * M_PI / 2048.0;
  Vector swing(4000), rounding(4000);
  Stream stream({1, "encoder", 0, 0, 0});
  for (Index t = 0; t < swing.size(); ++t) {
    swing(t) = std::sin(omega * dt * static_cast<double>(t));
    rounding(t) = count * (stream.uniform() - 0.5);
  }
  const Vector slope = slopes(swing, 11, dt);
  for (Index t = 5; t < swing.size() - 5; ++t) {
    EXPECT_NEAR(slope(t), omega * std::cos(omega * dt * static_cast<double>(t)), 1e-3 * omega);
  }
  const Vector noise = slopes(rounding, 11, dt);
  EXPECT_LT(std::sqrt(noise.squaredNorm() / 4000.0), 0.06);
}

TEST(Slopes, RejectWindowsThatDontFit) {
  for (const Index window : {3, 4, 6}) {
    EXPECT_TRUE(has(message_of<InputError>([&] { slopes(Vector::Zero(20), window, 0.1); }), "odd"));
  }
  EXPECT_TRUE(says(message_of<InputError>([] { slopes(Vector::Zero(6), 7, 0.1); }),
                   {"smoothing window = 7 samples", "must be <= 6"}));
}

}  // namespace
}  // namespace npdr::sim
