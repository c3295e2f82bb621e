#include "inference/dequantized_features.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "inference/feature_blocks.h"

namespace npdr::inference {

std::vector<Index> integer_features(const FeatureSource& x) {
  std::vector<Index> integers(static_cast<std::size_t>(x.num_features()));
  std::iota(integers.begin(), integers.end(), Index{0});
  for_each_block(x, std::min(kFirstRows, x.num_rows()), [&](Index, const RowMatrixF& rows) {
    std::erase_if(integers, [&](Index f) {
      return (rows.col(f).array() != rows.col(f).array().round()).any();
    });
  });
  return integers;
}

DequantizedFeatures::DequantizedFeatures(const FeatureSource& x, std::uint64_t seed)
    : x_(x), integers_(integer_features(x)), seed_(seed) {}

void DequantizedFeatures::gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
                                 RowMatrixF& x) const {
  x_.gather(rows, epoch, x);
  if (integers_.empty()) return;
  for (Index i = 0; i < x.rows(); ++i) {
    Stream stream({seed_, "dequantization", 0, rows[static_cast<std::size_t>(i)], epoch});
    for (const Index f : integers_) x(i, f) += static_cast<float>(stream.uniform() - 0.5);
  }
}

}  // namespace npdr::inference
