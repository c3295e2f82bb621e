/// Standardisation of features: z = (x - mean) / deviation, feature by feature.
#pragma once

#include <cmath>

#include "core/types.h"

namespace npdr::inference {

/// Mean and inverse deviation of each feature, from a stream of rows (Welford 1962). A feature that
/// doesn't vary gets the inverse deviation 0: it carries no information and is left out.
struct Standardiser {
  VectorF mean;               ///< (F)
  VectorF inverse_deviation;  ///< (F)

  void apply(RowMatrixF& x) const {
    x = (x.rowwise() - mean.transpose()).array().rowwise() * inverse_deviation.transpose().array();
  }
};

/// Accumulates rows one after the other.
class StandardiserFit {
 public:
  explicit StandardiserFit(Index num_features)
      : mean_(Vector::Zero(num_features)), squares_(Vector::Zero(num_features)) {}

  void add(const RowMatrixF& rows) {
    for (Index i = 0; i < rows.rows(); ++i) {
      ++count_;
      const Vector x = rows.row(i).transpose().cast<double>();
      const Vector before = x - mean_;
      mean_ += before / static_cast<double>(count_);
      squares_.array() += before.array() * (x - mean_).array();
    }
  }

  Standardiser result() const {
    const Eigen::ArrayXd deviation = (squares_.array() / static_cast<double>(count_)).sqrt();
    // Rounding leaves a little variance in a constant feature of single precision.
    const Eigen::ArrayXd threshold = 1e-6 * mean_.array().abs() + 1e-30;
    Standardiser s;
    s.mean = mean_.cast<float>();
    s.inverse_deviation = (deviation > threshold).select(1.0 / deviation, 0.0).cast<float>();
    return s;
  }

 private:
  Index count_ = 0;
  Vector mean_;
  Vector squares_;
};

}  // namespace npdr::inference
