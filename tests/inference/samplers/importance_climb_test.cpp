// Of ImportanceSampler: walkers that go on where flows are stuck.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "inference/samplers/importance_sampler.h"

namespace npdr::inference {
namespace {

// A thin curve that flows can't follow, of which they are stuck far below power 1:
// L(u) = exp(-(u_2 - sin 30 u_1)^2 / (2 s^2)), and as 30 u_1 is as good as uniform around the
// circle, Z = s E[exp(-sin^2(phi) / 2)] = s exp(-1/4) I_0(1/4).
TEST(ImportanceClimb, BeginsWhereFlowsAreStuck) {
  constexpr double s = 1e-3;
  ImportanceSampler sampler({.level_size = 500, .min_ess = 100.0, .max_simulations = 60'000}, 2, {},
                            {3, "refinement", 1, 0, 0});
  double climbs_from = 0.0;
  while (!sampler.is_done()) {
    if (sampler.state().walkers && climbs_from == 0.0) {
      climbs_from = sampler.power();
      const auto refuses = [](const ImportanceState& state) {
        EXPECT_THROW(ImportanceSampler({.level_size = 500}, 2, {}, {}, state), ShapeError);
      };
      ImportanceState state = sampler.state();
      EXPECT_NO_THROW(ImportanceSampler({.level_size = 500}, 2, {}, {}, state));
      state.walkers->u.conservativeResize(49, Eigen::NoChange);
      refuses(state);
      state = sampler.state();
      state.walkers->neighbors.conservativeResize(49, Eigen::NoChange);
      refuses(state);
      for (const Index nobody : {-1, 50}) {
        state = sampler.state();
        state.walkers->neighbors(7, 2) = nobody;
        refuses(state);
      }
      EXPECT_THROW(sampler.preliminary(1.0, 100), Error);
      EXPECT_THROW(sampler.settle(0.5), Error);
    }
    const RowMatrix u = sampler.next(500);
    sampler.tell(-0.5 / (s * s) * (u.col(1).array() - (30.0 * u.col(0).array()).sin()).square());
  }
  const ImportanceCertificate certificate = sampler.sample().certificate;
  EXPECT_GT(climbs_from, 0.0);
  EXPECT_LT(climbs_from, 0.5);
  EXPECT_EQ(certificate.power, 1.0);
  EXPECT_NEAR(certificate.log_evidence, std::log(s * std::exp(-0.25) * std::cyl_bessel_i(0, 0.25)),
              4.0 * certificate.log_evidence_error);
}

}  // namespace
}  // namespace npdr::inference
