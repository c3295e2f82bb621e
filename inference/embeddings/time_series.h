/// Embeddings that keep a time series as it is: all steps, differences, the last step.
#pragma once

#include "inference/embeddings/embedding.h"

namespace npdr::inference {

/// x = (s_1, ..., s_K) of every rollout, H K C' features.
class AllSteps : public Embedding {
 public:
  using Embedding::Embedding;
  Index num_features() const override;
  void embed(std::span<const float> picked, std::span<float> x) const override;
};

/// x = (s_2 - s_1, ..., s_K - s_{K-1}) of every rollout, H (K - 1) C' features.
class DeltaSteps : public Embedding {
 public:
  using Embedding::Embedding;
  Index num_features() const override;
  void embed(std::span<const float> picked, std::span<float> x) const override;
};

/// x = s_K of every rollout, H C' features.
class LastStep : public Embedding {
 public:
  using Embedding::Embedding;
  Index num_features() const override;
  void embed(std::span<const float> picked, std::span<float> x) const override;
};

}  // namespace npdr::inference
