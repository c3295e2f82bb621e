#include "sim/batch_vector.h"

#include <gtest/gtest.h>
#include <sundials/sundials_nvector.h>

#include <array>
#include <cstdint>
#include <numeric>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::sim {
namespace {

constexpr Index kSize = 24;

VectorPtr counting_vector(SUNContext context, double first) {
  VectorPtr vector = make_batch_vector(kSize, context);
  std::iota(values(vector.get()), values(vector.get()) + kSize, first);
  return vector;
}

TEST(BatchVector, ClonesStartAtACacheLineAndAreTheirOwn) {
  const ContextPtr context = make_context();
  const VectorPtr vector = counting_vector(context.get(), 1.0);
  const VectorPtr clone(N_VClone(vector.get()));
  const VectorPtr clone_of_clone(N_VClone(clone.get()));
  for (const auto* v : {&vector, &clone, &clone_of_clone}) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values(v->get())) % 64, 0u);
    EXPECT_EQ(N_VGetLength(v->get()), kSize);
  }
  EXPECT_NE(values(vector.get()), values(clone.get()));
}

TEST(BatchVector, LinearCombinationLeavesOutTermsWithoutWeight) {
  const ContextPtr context = make_context();
  const VectorPtr x = counting_vector(context.get(), 1.0);
  const VectorPtr bad = make_batch_vector(kSize, context.get());
  values(bad.get())[3] = kNaN;
  std::array<N_Vector, 2> terms = {x.get(), bad.get()};
  std::array<double, 2> coefficients = {2.0, 0.0};
  const VectorPtr sum(N_VClone(x.get()));
  ASSERT_EQ(N_VLinearCombination(2, coefficients.data(), terms.data(), sum.get()), 0);
  EXPECT_EQ(values(sum.get())[3], 8.0);
}

TEST(BatchVector, NormOfALaneThatDivergedIsZero) {
  const ContextPtr context = make_context();
  const VectorPtr x = make_batch_vector(kSize, context.get());
  values(x.get())[0] = kNaN;
  EXPECT_EQ(N_VWrmsNorm(x.get(), x.get()), 0.0);
}

TEST(BatchVector, RejectsLanesThatDontFillABlock) {
  const ContextPtr context = make_context();
  EXPECT_THROW(make_batch_vector(12, context.get()), ShapeError);
  EXPECT_THROW(make_batch_vector(0, context.get()), ShapeError);
}

}  // namespace
}  // namespace npdr::sim
