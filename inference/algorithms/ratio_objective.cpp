#include "inference/algorithms/ratio_objective.h"

#include <algorithm>

#include "inference/algorithms/atomic_loss.h"
#include "inference/algorithms/ratio_loss.h"

namespace npdr::inference {

RatioObjective::RatioObjective(const AlgorithmConfig& algorithm,
                               const RatioEstimator<float>& network,
                               const FeatureTransform& transform, const TrainingData& data,
                               const StreamId& id)
    : is_binary_(algorithm.kind == Algorithm::nre_a),
      num_atoms_(is_binary_ ? 2 : algorithm.num_atoms),
      network_(network),
      transform_(transform),
      data_(data),
      id_(id) {}

double RatioObjective::loss(const Parameters<float>& parameters, const Batch& batch,
                            Parameters<float>* gradient) {
  const auto n = static_cast<Index>(batch.rows.size());
  const Index k = std::min(num_atoms_, n);
  data_.x->gather(batch.rows, batch.epoch, raw_x_);
  transform_.apply(raw_x_, z_);
  Stream stream(of_batch(id_, "atoms", batch));
  const std::vector<std::uint32_t> atoms = draw_atoms(n, k, stream);
  atoms_.resize(n * k, data_.u.cols());
  for (Index i = 0; i < n * k; ++i) {
    atoms_.row(i) = data_.u.row(batch.rows[atoms[static_cast<std::size_t>(i)]]);
  }
  network_.logits(parameters, atoms_, z_, scratch_, logits_);
  const double loss = is_binary_ && k == 2 ? binary_ratio_loss(logits_, d_logits_)
                                           : categorical_ratio_loss(logits_, k, d_logits_);
  if (gradient != nullptr) {
    network_.backward(parameters, atoms_, z_, d_logits_, scratch_, *gradient);
  }
  return loss;
}

}  // namespace npdr::inference
