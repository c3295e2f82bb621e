#include "inference/estimators/trained_embedding.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

struct Layers {
  ParameterLayout layout;
  TrainedEmbedding<double> embedding;
  Vector parameters;

  Layers(const TrainedEmbeddingConfig& config, Index num_inputs)
      : embedding(config, num_inputs, layout), parameters(Vector::Zero(layout.size())) {
    Stream stream({3, "initial", 0, 0, 0});
    embedding.initialize(parameters, stream);
    for (const Layer& layer : layout.layers()) {  // biases that begin at 0 count, too
      if (layer.rows.value == 1) view(parameters, layer.block).array() += 0.1;
    }
  }
  RowMatrix context(const RowMatrix& z) const {
    TrainedEmbedding<double>::Scratch scratch;
    RowMatrix c;
    embedding.forward(parameters, z, scratch, c);
    return c;
  }
  Eigen::Map<const RowMatrix> weights(const std::string& name) const {
    for (const Layer& layer : layout.layers()) {
      if (layer.name == name) return view(parameters, layer.block);
    }
    throw std::out_of_range(name);
  }
};

// The definition, value by value: y (K, C) of one rollout.
RowMatrix convolved(const Layers& layers, const std::string& name, const RowMatrix& y) {
  const auto weight = layers.weights(name + ".weight");
  const auto bias = layers.weights(name + ".bias");
  const Index steps = (y.rows() - 8) / 4 + 1, first = (y.rows() - 8) % 4;
  RowMatrix out(steps, weight.cols());
  for (Index t = 0; t < steps; ++t) {
    for (Index o = 0; o < weight.cols(); ++o) {
      double sum = bias(0, o);
      for (Index k = 0; k < 8; ++k) {
        for (Index c = 0; c < y.cols(); ++c) {
          sum += y(first + 4 * t + k, c) * weight(k * y.cols() + c, o);
        }
      }
      out(t, o) = std::max(0.0, sum);
    }
  }
  return out;
}

constexpr SeriesShape kSeries{3, 42, 2};  // 42 steps become 9, and these 1

TEST(TrainedEmbedding, IsWhatItsDefinitionSays) {
  for (const bool average_rollouts : {false, true}) {
    const Layers layers({5, kSeries, average_rollouts}, kSeries.num_values());
    const RowMatrix z = random_matrix(4, kSeries.num_values(), 1);
    const RowMatrix context = layers.context(z);
    for (Index i = 0; i < z.rows(); ++i) {
      RowMatrix last(3, 32);
      for (Index h = 0; h < 3; ++h) {
        const RowMatrix rollout = Eigen::Map<const RowMatrix>(z.row(i).data() + h * 84, 42, 2);
        const RowMatrix first = convolved(layers, "convolution_1", rollout);
        ASSERT_EQ(first.rows(), 9);
        last.row(h) = convolved(layers, "convolution_2", first);
      }
      Vector inputs = Eigen::Map<const Vector>(last.data(), last.size());
      if (average_rollouts) inputs = last.colwise().mean();
      const Vector expected = layers.weights("linear.weight").transpose() * inputs +
                              layers.weights("linear.bias").row(0).transpose();
      EXPECT_LT((context.row(i).transpose() - expected).norm(), 1e-12);
    }
  }
}

TEST(TrainedEmbedding, BackwardPassEqualsCentralDifferences) {
  const TrainedEmbeddingConfig linear{5};
  const TrainedEmbeddingConfig items{5, {12, 3, 2}, true};
  for (const auto& config :
       {TrainedEmbeddingConfig{5, kSeries}, {5, kSeries, true}, items, linear}) {
    const Index inputs = std::max<Index>(config.series.num_values(), 42);
    const Layers layers(config, inputs);
    const RowMatrix z = random_matrix(4, inputs, 1), d_context = random_matrix(4, 5, 2);
    TrainedEmbedding<double>::Scratch scratch;
    RowMatrix context;
    layers.embedding.forward(layers.parameters, z, scratch, context);
    Vector gradient = Vector::Zero(layers.layout.size());
    layers.embedding.backward(layers.parameters, z, d_context, scratch, gradient);
    expect_gradient(
        [&](const Vector& p) {
          layers.embedding.forward(p, z, scratch, context);
          return context.cwiseProduct(d_context).sum();
        },
        layers.parameters, gradient);
  }
}

// Whatever their order: then it may change from recording to recording.
TEST(TrainedEmbedding, OfAMeanOverRolloutsKnowsNoOrderOfThem) {
  const RowMatrix z = random_matrix(2, kSeries.num_values(), 1);
  RowMatrix turned(z.rows(), z.cols());
  turned << z.rightCols(84), z.leftCols(2 * 84);
  const Layers mean({5, kSeries, true}, z.cols()), each({5, kSeries}, z.cols());
  EXPECT_LT((mean.context(z) - mean.context(turned)).norm(), 1e-12);
  EXPECT_GT((each.context(z) - each.context(turned)).norm(), 1e-2);
}

TEST(TrainedEmbedding, OfShortSeriesIsLinear) {
  const Layers layers({5, {2, 7, 3}}, 42);
  EXPECT_EQ(layers.layout.layers().size(), 2u);
}

// The mean of items that are all seen by themselves: f(x_1, ..., x_n) = mean_i g(x_i).
TEST(TrainedEmbedding, OfShortItemsIsTheMeanOfANonlinearLayer) {
  const Layers set({5, {12, 3, 2}, true}, 72), item({5, {1, 3, 2}, true}, 6);
  ASSERT_EQ(set.parameters.size(), item.parameters.size());
  const RowMatrix z = random_matrix(1, 72, 1);
  const RowMatrix items = Eigen::Map<const RowMatrix>(z.data(), 12, 6);
  const RowMatrix of_each = item.context(items);
  EXPECT_LT((set.context(z) - of_each.colwise().mean()).norm(), 1e-12);
  EXPECT_GT((of_each.colwise().mean() - item.context(items.colwise().mean())).norm(), 1e-3);
}

TEST(TrainedEmbedding, RefusesSeriesOfAnotherSize) {
  ParameterLayout layout;
  EXPECT_THROW(TrainedEmbedding<float>({5, {2, 7, 3}}, 41, layout), ShapeError);
}

}  // namespace
}  // namespace npdr::inference
