#include "inference/samplers/resampler.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::inference {
namespace {

TEST(Resampler, DrawsSystematicallyAsOftenAsWeightsSay) {
  const Resampler resampler(Vector{{1.0, 0.0, 2.5, 0.5}});
  EXPECT_EQ(resampler.systematic(4, 0.25), (std::vector<Index>{0, 2, 2, 2}));
  EXPECT_EQ(resampler.systematic(4, 0.75), (std::vector<Index>{0, 2, 2, 3}));
  EXPECT_EQ(resampler.systematic(2, 0.9), (std::vector<Index>{2, 3}));
}

TEST(Resampler, RejectsWeightsThatAreNone) {
  Vector weights(3);
  for (const double bad : {-1.0, kNaN, kInfinity}) {
    weights << 0.2, bad, 0.3;
    EXPECT_THROW(Resampler{weights}, Error);
  }
  EXPECT_THROW(Resampler{Vector::Zero(3)}, Error);
}

}  // namespace
}  // namespace npdr::inference
