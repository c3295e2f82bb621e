#include "inference/least_squares/normal_equations.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace npdr::inference {
namespace {

// Rows of errors (H K, C) as one column.
auto flat(const RowMatrix& errors, Index begin, Index count) {
  return errors.middleRows(begin, count).reshaped<Eigen::RowMajor>();
}

}  // namespace

NormalEquations::NormalEquations(const WeightedErrors& errors, const Vector& unknowns,
                                 const std::vector<Index>& begins, Index num_rollouts) {
  const Index rows = errors.weights.rows(), channels = errors.weights.cols();
  const Index steps = rows / num_rollouts, count = std::ssize(begins);
  const Index dimension = unknowns.size() - num_rollouts * count * channels;
  const RowMatrix scaled =
      errors.weights.reshaped<Eigen::RowMajor>().cwiseSqrt().asDiagonal() * errors.slopes;
  const auto of_u = scaled.leftCols(dimension);
  curvature_ = of_u.transpose() * of_u;
  gradient_ = errors.slopes.leftCols(dimension).transpose() * flat(errors.gradients, 0, rows);
  gradient_ += unknowns.head(dimension);
  for (Index i = 0; i < num_rollouts * count; ++i) {
    const Index h = i / count, s = i % count;
    const Index begin = begins[static_cast<std::size_t>(s)];
    const Index end = s + 1 < count ? begins[static_cast<std::size_t>(s + 1)] : steps;
    Block block;
    block.begin = h * steps + begin;
    block.count = end - begin;
    block.own = unknowns.segment(dimension + i * channels, channels);
    const auto part = scaled.middleRows(block.begin * channels, block.count * channels);
    const RowMatrix own =
        with_prior(part.rightCols(channels).transpose() * part.rightCols(channels));
    const RowMatrix cross = part.rightCols(channels).transpose() * part.leftCols(dimension);
    const Vector gradient = errors.slopes.middleRows(block.begin * channels, block.count * channels)
                                    .rightCols(channels)
                                    .transpose() *
                                flat(errors.gradients, block.begin, block.count) +
                            block.own;
    const Eigen::LLT<Eigen::MatrixXd> root(own);
    block.follows = root.solve(cross);
    block.rest = root.solve(gradient);
    curvature_ -= cross.transpose() * block.follows;
    gradient_ -= cross.transpose() * block.rest;
    own_gain_ += gradient.dot(block.rest);
    blocks_.push_back(std::move(block));
  }
}

double NormalEquations::promised() const {
  return 0.5 * (gradient_.dot(with_prior(curvature_).ldlt().solve(gradient_)) + own_gain_);
}

Vector NormalEquations::step(double damping, double longest) const {
  RowMatrix normal = with_prior(curvature_);
  normal.diagonal() *= 1.0 + damping;
  Vector of_u = -normal.ldlt().solve(gradient_);
  of_u *= longest / std::max(longest, of_u.norm());
  const Index dimension = of_u.size(), channels = blocks_.empty() ? 0 : blocks_.front().own.size();
  Vector step(dimension + std::ssize(blocks_) * channels);
  step.head(dimension) = of_u;
  for (Index i = 0; i < std::ssize(blocks_); ++i) {
    const Block& block = blocks_[static_cast<std::size_t>(i)];
    step.segment(dimension + i * channels, channels) =
        -block.rest / (1.0 + damping) - block.follows * of_u;
  }
  return step;
}

RowMatrix NormalEquations::scores_of_steps(const WeightedErrors& errors) const {
  const Index channels = errors.weights.cols(), dimension = curvature_.rows();
  RowMatrix scores(errors.weights.rows(), dimension);
  for (Index t = 0; t < scores.rows(); ++t) {
    scores.row(t) = errors.gradients.row(t) *
                    errors.slopes.middleRows(t * channels, channels).leftCols(dimension);
  }
  for (const Block& block : blocks_) {
    for (Index t = block.begin; t < block.begin + block.count; ++t) {
      const auto of_own = errors.slopes.middleRows(t * channels, channels).rightCols(channels);
      scores.row(t) -= errors.gradients.row(t) * of_own * block.follows;
    }
    scores.row(block.begin) -= block.own.transpose() * block.follows;
  }
  return scores;
}

RowMatrix with_prior(RowMatrix curvature) {
  curvature.diagonal().array() += 1.0;
  return curvature;
}

}  // namespace npdr::inference
