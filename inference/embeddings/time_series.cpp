#include "inference/embeddings/time_series.h"

#include <algorithm>

namespace npdr::inference {
namespace {

// Rollout h of a picked series as a (K, C') view.
Eigen::Map<const RowMatrixF> rollout(const SeriesSelection& s, std::span<const float> picked,
                                     Index h) {
  return {picked.data() + h * s.num_steps() * s.num_channels(), s.num_steps(), s.num_channels()};
}

}  // namespace

Index AllSteps::num_features() const { return selection().num_values(); }

void AllSteps::embed(std::span<const float> picked, std::span<float> x) const {
  std::copy(picked.begin(), picked.end(), x.begin());
}

Index DeltaSteps::num_features() const {
  return selection().num_rollouts * (selection().num_steps() - 1) * selection().num_channels();
}

void DeltaSteps::embed(std::span<const float> picked, std::span<float> x) const {
  const SeriesSelection& s = selection();
  Eigen::Map<RowMatrixF> out(x.data(), s.num_rollouts * (s.num_steps() - 1), s.num_channels());
  for (Index h = 0; h < s.num_rollouts; ++h) {
    const auto states = rollout(s, picked, h);
    const Index count = s.num_steps() - 1;
    out.middleRows(h * count, count) = states.bottomRows(count) - states.topRows(count);
  }
}

Index LastStep::num_features() const {
  return selection().num_rollouts * selection().num_channels();
}

void LastStep::embed(std::span<const float> picked, std::span<float> x) const {
  const SeriesSelection& s = selection();
  Eigen::Map<RowMatrixF> out(x.data(), s.num_rollouts, s.num_channels());
  for (Index h = 0; h < s.num_rollouts; ++h) {
    out.row(h) = rollout(s, picked, h).bottomRows(1);
  }
}

}  // namespace npdr::inference
