#include "inference/embeddings/time_series.h"

namespace npdr::inference {

AllSteps::AllSteps(SeriesSelection selection) : selection_(std::move(selection)) {}

Index AllSteps::num_features() const {
  return selection_.num_rollouts * selection_.num_steps() * selection_.num_channels();
}

void AllSteps::embed(std::span<const float> series, std::span<float> x) const {
  auto out = x.begin();
  for (Index h = 0; h < selection_.num_rollouts; ++h) {
    for (Index k = 0; k < selection_.num_steps(); ++k) {
      for (Index c = 0; c < selection_.num_channels(); ++c) {
        *out++ = selection_.value(series, h, k, c);
      }
    }
  }
}

DeltaSteps::DeltaSteps(SeriesSelection selection) : selection_(std::move(selection)) {}

Index DeltaSteps::num_features() const {
  return selection_.num_rollouts * (selection_.num_steps() - 1) * selection_.num_channels();
}

void DeltaSteps::embed(std::span<const float> series, std::span<float> x) const {
  auto out = x.begin();
  for (Index h = 0; h < selection_.num_rollouts; ++h) {
    for (Index k = 0; k + 1 < selection_.num_steps(); ++k) {
      for (Index c = 0; c < selection_.num_channels(); ++c) {
        *out++ = selection_.value(series, h, k + 1, c) - selection_.value(series, h, k, c);
      }
    }
  }
}

LastStep::LastStep(SeriesSelection selection) : selection_(std::move(selection)) {}

Index LastStep::num_features() const { return selection_.num_rollouts * selection_.num_channels(); }

void LastStep::embed(std::span<const float> series, std::span<float> x) const {
  auto out = x.begin();
  for (Index h = 0; h < selection_.num_rollouts; ++h) {
    for (Index c = 0; c < selection_.num_channels(); ++c) {
      *out++ = selection_.value(series, h, selection_.num_steps() - 1, c);
    }
  }
}

}  // namespace npdr::inference
