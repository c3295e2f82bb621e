/// x of simulations, with observation noise.
///
/// Rows that failed are left out. Where the noise is redrawn, the picked states are kept and every
/// gather() adds the noise of its epoch to them before the embedding; otherwise x itself is kept,
/// with the noise of epoch 0. Noise of a row is keyed by (seed, round, row, epoch).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/random.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "inference/embeddings/embedding.h"
#include "inference/feature_source.h"
#include "inference/feature_transform.h"
#include "pipeline/features/observation.h"
#include "pipeline/features/row_store.h"
#include "pipeline/plan/plan.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

class SimulationFeatures : public inference::FeatureSource {
 public:
  /// Reads `simulations`, in blocks. Throws InputError where all of their rows failed.
  SimulationFeatures(const Plan& plan, const std::vector<const Node*>& simulations,
                     const Observation& observation, const inference::Embedding& embedding);

  Index num_rows() const override { return static_cast<Index>(origin_.size()); }
  Index num_features() const override { return embedding_.num_features(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
              RowMatrixF& x) const override;

  const RowMatrix& theta() const { return theta_; }  ///< (N, D)
  std::vector<std::uint32_t> rounds() const;         ///< (N); 0: of calibration
  std::vector<Index> rows() const;                   ///< (N), in the simulation of their round
  Index num_failed() const { return num_failed_; }
  /// (R) rows of each simulation, failed ones too.
  const std::vector<Index>& num_simulated() const { return num_simulated_; }

 private:
  struct Origin {
    std::uint32_t round;
    std::uint32_t row;
  };
  void read_theta(const h5::File& file, std::uint32_t round);
  void read_series(const std::vector<h5::File>& files);
  void add_noise(std::span<float> picked, const Origin& origin, std::uint64_t epoch) const;

  const inference::Embedding& embedding_;
  sim::NoiseModel noise_;
  bool redraws_;
  std::uint64_t seed_;
  RowMatrix theta_;
  std::vector<Origin> origin_;
  std::vector<Index> end_;  // of the rows of each simulation
  Index num_failed_ = 0;
  std::vector<Index> num_simulated_;
  std::unique_ptr<RowStore> rows_;
};

/// Features in units of their deviation over the rows of `simulation` that didn't fail, without
/// observation noise; `tails`: what becomes of those that span orders of magnitude. Rows are read
/// in blocks. Where all have failed no feature varies. Throws InputError for a damaged artefact.
inference::FeatureTransform scale_of_features(const Node& simulation, inference::Tails tails);

/// What x of a study's simulations usually is, for the test of observations among them: that of at
/// most `most_rows` of them, 80 or more, which `stream` picks; of fewer, but 80, where
/// they have more than 10,000 features. `tails`: as the posterior's networks see them. What isn't
/// finite is left out; none of fewer than inference::kFewestSimulations.
std::optional<inference::UsualFeatures> usual_features_of(const inference::FeatureSource& features,
                                                          inference::Tails tails, Index most_rows,
                                                          const StreamId& stream);

}  // namespace npdr::pipeline
