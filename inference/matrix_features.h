/// x that is in memory already.
#pragma once

#include "inference/feature_source.h"

namespace npdr::inference {

/// Keeps a reference to x (N, F).
class MatrixFeatures : public FeatureSource {
 public:
  explicit MatrixFeatures(const RowMatrixF& x) : x_(x) {}
  Index num_rows() const override { return x_.rows(); }
  Index num_features() const override { return x_.cols(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t /*epoch*/,
              RowMatrixF& x) const override {
    x.resize(static_cast<Index>(rows.size()), x_.cols());
    Index next = 0;
    for (const std::uint32_t row : rows) x.row(next++) = x_.row(row);
  }

 private:
  const RowMatrixF& x_;
};

}  // namespace npdr::inference
