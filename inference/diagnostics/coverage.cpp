#include "inference/diagnostics/coverage.h"

namespace npdr::inference {

Index density_rank(const Vector& log_prob_of_samples, double log_prob_of_truth) {
  return (log_prob_of_samples.array() > log_prob_of_truth).count();
}

Index distance_rank(const RowMatrix& samples, const Vector& truth, const Vector& reference) {
  const double distance = (truth - reference).squaredNorm();
  const Vector distances = (samples.rowwise() - reference.transpose()).rowwise().squaredNorm();
  return (distances.array() < distance).count();
}

Coverage measure_coverage(const Vector& spread) {
  constexpr Index num_levels = 101;
  Coverage result;
  result.kolmogorov_smirnov = test_kolmogorov_smirnov(spread);
  result.level = Vector::LinSpaced(num_levels, 0.0, 1.0);
  result.coverage.resize(num_levels);
  for (Index i = 0; i < num_levels; ++i) {
    const auto within = (spread.array() <= result.level(i)).count();
    result.coverage(i) = static_cast<double>(within) / static_cast<double>(spread.size());
  }
  constexpr Index above = num_levels / 2;
  result.area = (result.coverage - result.level).tail(above).mean();
  return result;
}

}  // namespace npdr::inference
