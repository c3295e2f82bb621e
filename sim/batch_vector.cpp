#include "sim/batch_vector.h"

#include <nvector/nvector_serial.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <new>
#include <string>

#include "core/error.h"
#include "sim/lanes.h"

namespace npdr::sim {
namespace {

constexpr std::size_t kCacheLine = 64;  // [bytes]

// The serial vector frees its data with free(), as memory of aligned_alloc may be.
double* allocate(Index size) {
  const std::size_t bytes = static_cast<std::size_t>(size) * sizeof(double);
  auto* data = static_cast<double*>(std::aligned_alloc(kCacheLine, bytes));
  if (data == nullptr) throw std::bad_alloc();
  std::fill_n(data, size, 0.0);
  return data;
}

void attach_values(N_Vector vector, Index size) {
  N_VSetArrayPointer(allocate(size), vector);
  NV_OWN_DATA_S(vector) = SUNTRUE;
}

N_Vector clone(N_Vector vector) {
  N_Vector copy = N_VCloneEmpty_Serial(vector);
  if (copy != nullptr) attach_values(copy, NV_LENGTH_S(vector));
  return copy;
}

void scale(realtype c, N_Vector x, N_Vector z) {
  const double* const from = values(x);
  double* const to = values(z);
  const Index size = NV_LENGTH_S(x);
  if (c == 1.0) {
    std::copy_n(from, size, to);
  } else {
    for_each_lane(size, [&](Index i) { to[i] = c * from[i]; });
  }
}

constexpr std::size_t kMaxTerms = 8;  // six stages of the largest method, and the state
using Coefficients = std::array<double, kMaxTerms>;
using Terms = std::array<const double*, kMaxTerms>;

// z = sum_k c_k x_k over `Count` terms: a compile-time count keeps the sum in a register.
template <std::size_t Count>
void combine(const Coefficients& c, const Terms& x, double* z, Index size) {
  for_each_lane(size, [c, x, z](Index i) {
    double sum = c[0] * x[0][i];
    for (std::size_t k = 1; k < Count; ++k) sum += c[k] * x[k][i];
    z[i] = sum;
  });
}

constexpr std::array kCombine = {&combine<1>, &combine<2>, &combine<3>, &combine<4>,
                                 &combine<5>, &combine<6>, &combine<7>, &combine<8>};
static_assert(kCombine.size() == kMaxTerms);

int linear_combination(int num_terms, realtype* c, N_Vector* x, N_Vector z) {
  Coefficients coefficients{};
  Terms terms{values(x[0])};
  std::size_t count = 0;
  for (int k = 0; k < num_terms; ++k) {
    if (c[k] == 0.0) continue;
    if (count == kMaxTerms) return -1;
    coefficients[count] = c[k];
    terms[count++] = values(x[k]);
  }
  kCombine[std::max<std::size_t>(count, 1) - 1](coefficients, terms, values(z), NV_LENGTH_S(z));
  return 0;
}

realtype wrms_norm(N_Vector /*x*/, N_Vector /*weights*/) { return 0.0; }

}  // namespace

void ContextDeleter::operator()(SUNContext context) const { SUNContext_Free(&context); }

ContextPtr make_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) throw Error("SUNDIALS: no context");
  return ContextPtr(context);
}

void VectorDeleter::operator()(N_Vector vector) const { N_VDestroy(vector); }

VectorPtr make_batch_vector(Index size, SUNContext context) {
  if (size <= 0 || size % kLaneBlock != 0) {
    throw ShapeError("batch vector of " + std::to_string(size) +
                     " values, must be a positive multiple of " + std::to_string(kLaneBlock));
  }
  VectorPtr vector(N_VNewEmpty_Serial(size, context));
  if (vector == nullptr) throw std::bad_alloc();
  attach_values(vector.get(), size);
  vector->ops->nvclone = clone;
  vector->ops->nvlinearcombination = linear_combination;
  vector->ops->nvscale = scale;
  vector->ops->nvwrmsnorm = wrms_norm;
  return vector;
}

double* values(N_Vector vector) { return NV_DATA_S(vector); }

}  // namespace npdr::sim
