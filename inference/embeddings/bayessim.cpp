#include "inference/embeddings/bayessim.h"

#include <algorithm>

namespace npdr::inference {

BayesSim::BayesSim(SeriesSelection selection, const Target& target, Index steps_per_state)
    : Embedding(std::move(selection)) {
  for (Index h = 0; h < this->selection().num_rollouts; ++h) {
    const RowMatrix& all = target.rollouts[static_cast<std::size_t>(h)].actions;
    RowMatrix between(this->selection().num_steps() - 1, all.cols());
    for (Index k = 0; k < between.rows(); ++k) {
      // State k is the one after step (k + 1) * steps_per_state, counted from 1.
      between.row(k) = all.middleRows((k + 1) * steps_per_state, steps_per_state).colwise().mean();
    }
    actions_.push_back(std::move(between));
  }
}

Index BayesSim::num_features() const {
  const Index num_actions = actions_.front().cols();
  return selection().num_rollouts * selection().num_channels() * (num_actions + 2);
}

void BayesSim::embed(std::span<const float> picked, std::span<float> x) const {
  auto out = x.begin();
  const Index steps = selection().num_steps();
  const Index channels = selection().num_channels();
  for (Index h = 0; h < selection().num_rollouts; ++h) {
    const RowMatrix& actions = actions_[static_cast<std::size_t>(h)];
    const RowMatrix states =
        Eigen::Map<const RowMatrixF>(picked.data() + h * steps * channels, steps, channels)
            .cast<double>();
    const RowMatrix delta = states.bottomRows(steps - 1) - states.topRows(steps - 1);
    const RowMatrix products = actions.transpose() * delta;
    const Eigen::RowVectorXd mean = delta.colwise().mean();
    const Eigen::RowVectorXd variance =
        (delta.rowwise() - mean).colwise().squaredNorm() / static_cast<double>(delta.rows());
    out = std::transform(products.data(), products.data() + products.size(), out,
                         [](double v) { return static_cast<float>(v); });
    out = std::transform(mean.begin(), mean.end(), out,
                         [](double v) { return static_cast<float>(v); });
    out = std::transform(variance.begin(), variance.end(), out,
                         [](double v) { return static_cast<float>(v); });
  }
}

}  // namespace npdr::inference
