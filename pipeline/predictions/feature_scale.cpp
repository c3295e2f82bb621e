#include "pipeline/predictions/feature_scale.h"

#include <vector>

#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"

namespace npdr::pipeline {
namespace {

// Simulated features as they are in their file.
class StoredFeatures : public inference::FeatureSource {
 public:
  explicit StoredFeatures(const h5::File& file) : values_(simulated_values(file)) {
    const auto status = file.dataset("status").read<std::uint8_t>();
    for (Index i = 0; i < std::ssize(status); ++i) {
      if (status[static_cast<std::size_t>(i)] == 0) rows_.push_back(i);
    }
  }

  Index num_rows() const override { return std::ssize(rows_); }
  Index num_features() const override { return values_.row_size(); }

  // Of ascending rows, as blocks are, what lies between is read with them.
  void gather(std::span<const std::uint32_t> rows, std::uint64_t /*epoch*/,
              RowMatrixF& x) const override {
    const Index first = rows_[rows.front()];
    RowMatrixF between(rows_[rows.back()] - first + 1, num_features());
    values_.read_rows<float>(first, between.rows(),
                             {between.data(), static_cast<std::size_t>(between.size())});
    x.resize(std::ssize(rows), num_features());
    Index next = 0;
    for (const std::uint32_t row : rows) x.row(next++) = between.row(rows_[row] - first);
  }

 private:
  h5::Dataset values_;
  std::vector<Index> rows_;
};

}  // namespace

inference::FeatureTransform scale_of_features(const Node& simulation, inference::Tails tails) {
  const h5::File file = open_artefact(simulation.path, kSimulationSchema, simulation.key);
  const StoredFeatures features(file);
  if (features.num_rows() > 0) return inference::fit_feature_transform(features, 0, tails);
  inference::FeatureTransform constant;
  constant.mean = constant.inverse_deviation = VectorF::Zero(features.num_features());
  return constant;
}

}  // namespace npdr::pipeline
