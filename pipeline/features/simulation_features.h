/// x of simulations, with observation noise, and how far simulations are from the target.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/random.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "inference/embeddings/embedding.h"
#include "inference/feature_source.h"
#include "inference/feature_transform.h"
#include "pipeline/features/observation.h"
#include "pipeline/plan/plan.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// Rows of floats (n, width) that are written once and then read in any order: in memory when they
/// are few, else in an unnamed file that vanishes with the process. Reads of the file go through
/// the system's page cache, so they are fast while memory is free and cost none when it isn't.
/// Reading is thread-safe.
class RowStore {
 public:
  /// `folder`: where the file may be. Throws Error when it can't be made.
  RowStore(Index num_rows, Index width, const std::filesystem::path& folder);
  ~RowStore();
  RowStore(const RowStore&) = delete;
  RowStore& operator=(const RowStore&) = delete;

  Index width() const { return width_; }

  void write(Index row, std::span<const float> values);
  void read(Index row, std::span<float> values) const;

 private:
  Index width_;
  std::vector<float> memory_;
  int file_ = -1;
};

/// Rows that failed are left out. Where the noise is redrawn, the picked states are kept and every
/// gather() adds the noise of its epoch to them before the embedding; otherwise x itself is kept,
/// with the noise of epoch 0. Noise of a row is keyed by (seed, round, row, epoch).
class SimulationFeatures : public inference::FeatureSource {
 public:
  /// Reads `simulations`, in blocks. Throws InputError where all of their rows failed.
  SimulationFeatures(const Plan& plan, const std::vector<const Node*>& simulations,
                     const Observation& observation, const inference::Embedding& embedding);

  Index num_rows() const override { return std::ssize(row_); }
  Index num_features() const override { return embedding_.num_features(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
              RowMatrixF& x) const override;

  const RowMatrix& theta() const { return theta_; }  ///< (N, D)
  /// Round of each row, (N); 0: calibration.
  const std::vector<std::uint32_t>& rounds() const { return round_; }
  /// Number of each row in the simulation of its round, (N).
  const std::vector<Index>& rows() const { return row_; }
  Index num_failed() const { return num_failed_; }
  /// (R) rows of each simulation, failed ones too.
  const std::vector<Index>& num_simulated() const { return num_simulated_; }

 private:
  void read_theta(const h5::File& file, std::uint32_t round);
  void read_series(const std::vector<h5::File>& files);
  void add_noise(std::span<float> picked, std::size_t i, std::uint64_t epoch) const;

  const inference::Embedding& embedding_;
  sim::NoiseModel noise_;
  bool redraws_;
  std::uint64_t seed_;
  RowMatrix theta_;
  std::vector<std::uint32_t> round_;
  std::vector<Index> row_;
  std::vector<Index> end_;  // of the rows of each simulation
  Index num_failed_ = 0;
  std::vector<Index> num_simulated_;
  std::unique_ptr<RowStore> rows_;
};

/// Features in units of their deviation over the rows of `simulation` that didn't fail, without
/// observation noise; `tails`: what becomes of those that span orders of magnitude. Rows are read
/// in blocks. Where all have failed no feature varies. Throws InputError for a damaged artefact.
inference::FeatureTransform scale_of_features(const Node& simulation, inference::Tails tails);

/// How far every row of the simulation `node` is from `target`, by RMSE or DTW
/// (analysis/metrics.h), (N); infinite for those that failed. Compared are the states that were
/// stored, every store_every-th, without observation noise on either side. Reads the rows in
/// blocks, so memory doesn't grow with their number; the same bits on any number of threads.
Vector metric_distances(const Plan& plan, const Node& node, const Target& target,
                        inference::AbcDistance metric);

/// What x of a study's simulations usually is, for the test of observations among them: that of at
/// most `most_rows` of them, 80 or more, which `stream` picks; of fewer, but 80, where
/// they have more than 10,000 features. `tails`: as the posterior's networks see them. What isn't
/// finite is left out; none of fewer than inference::kFewestSimulations.
std::optional<inference::UsualFeatures> usual_features_of(const inference::FeatureSource& features,
                                                          inference::Tails tails, Index most_rows,
                                                          const StreamId& stream);

}  // namespace npdr::pipeline
