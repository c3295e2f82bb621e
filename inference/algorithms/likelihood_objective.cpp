#include "inference/algorithms/likelihood_objective.h"

namespace npdr::inference {

LikelihoodObjective::LikelihoodObjective(Of of, const EmbeddedEstimator<float>& network,
                                         const FeatureTransform& transform,
                                         const TrainingData& data, std::vector<std::uint32_t> rows,
                                         VectorF weights)
    : of_(of),
      network_(network),
      transform_(transform),
      data_(data),
      rows_(std::move(rows)),
      weights_(std::move(weights)),
      scratch_(network.make_scratch()) {}

double LikelihoodObjective::loss(const Parameters<float>& parameters, const Batch& batch,
                                 Parameters<float>* gradient) {
  const auto n = static_cast<Index>(batch.rows.size());
  batch_rows_.clear();
  for (const std::uint32_t row : batch.rows) batch_rows_.push_back(rows_[row]);
  data_.x->gather(batch_rows_, batch.epoch, raw_x_);
  transform_.apply(raw_x_, z_);
  u_.resize(n, data_.u.cols());
  d_log_prob_.setConstant(n, -1.0f / static_cast<float>(n));
  for (Index i = 0; i < n; ++i) {
    const std::uint32_t row = batch_rows_[static_cast<std::size_t>(i)];
    u_.row(i) = data_.u.row(row);
    if (weights_.size() > 0) d_log_prob_(i) *= weights_(row);
  }
  const bool is_likelihood = of_ == Of::z_given_u;
  const RowMatrixF& value = is_likelihood ? z_ : u_;
  const RowMatrixF& context = is_likelihood ? u_ : z_;
  network_.log_prob(parameters, value, context, scratch_, log_prob_);
  if (gradient != nullptr) {
    network_.backward(parameters, value, context, d_log_prob_, scratch_, *gradient);
  }
  return static_cast<double>(d_log_prob_.dot(log_prob_));
}

}  // namespace npdr::inference
