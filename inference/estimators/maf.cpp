#include "inference/estimators/maf.h"

#include <cmath>
#include <string>

#include "core/constants.h"
#include "inference/estimators/affine_map.h"
#include "inference/estimators/dense.h"
#include "inference/estimators/scalar.h"
#include "inference/estimators/size_check.h"
#include "inference/estimators/spline_map.h"

namespace npdr::inference {
namespace {

template <typename S>
void permute(const ColumnMatrixX<S>& from, const std::vector<std::uint32_t>& order,
             ColumnMatrixX<S>& to) {
  to.resize(from.rows(), from.cols());
  for (Index j = 0; j < from.cols(); ++j) to.col(j) = from.col(order[static_cast<std::size_t>(j)]);
}

template <typename S>
void permute_back(const ColumnMatrixX<S>& from, const std::vector<std::uint32_t>& order,
                  ColumnMatrixX<S>& to) {
  to.resize(from.rows(), from.cols());
  for (Index j = 0; j < from.cols(); ++j) to.col(order[static_cast<std::size_t>(j)]) = from.col(j);
}

template <typename S>
std::shared_ptr<const ElementMap<S>> make_map(const EstimatorConfig& config) {
  if (config.kind == EstimatorKind::nsf) return std::make_shared<SplineMap<S>>(config.num_bins);
  return std::make_shared<AffineMap<S>>();
}

}  // namespace

template <typename S>
struct MaskedAutoregressiveFlow<S>::Scratch : EstimatorScratch {
  RowMatrixX<S> context;    ///< (n, K hidden): c W_c + b
  RowMatrixX<S> d_context;  ///< (n, K hidden)
  std::vector<AutoregressiveScratch<S>> transforms;
  ColumnMatrixX<S> z;         ///< (n k, D)
  ColumnMatrixX<S> d_z;       ///< (n k, D)
  ColumnMatrixX<S> permuted;  ///< (n k, D)
};

template <typename S>
MaskedAutoregressiveFlow<S>::MaskedAutoregressiveFlow(const EstimatorConfig& config,
                                                      Index dimension, Index context_features,
                                                      const StreamId& structure,
                                                      ParameterLayout& layout)
    : dimension_(dimension), context_features_(context_features) {
  check_size("num_transforms", config.num_transforms);
  check_size("hidden_features", config.hidden_features);
  check_size("num_hidden_layers", config.num_hidden_layers);
  const Size width{config.num_transforms * config.hidden_features, "K h"};
  context_weight_ = layout.add("context.weight", {context_features, "c"}, width,
                               "W_c of all K transforms, one beside the other");
  context_bias_ = layout.add_bias("context.bias", width, "b_1 of all of them");
  const auto map = make_map<S>(config);
  Stream stream(structure);
  for (Index k = 0; k < config.num_transforms; ++k) {
    layout.begin_names_with("transform_" + std::to_string(k + 1) + ".");
    order_.push_back(stream.permutation(static_cast<std::uint32_t>(dimension)));
    layout.note("order", {dimension, "v"},
                "variable j of a transform is variable order[j] of what comes in",
                {order_.back().begin(), order_.back().end()});
    transforms_.emplace_back(dimension, config.hidden_features, config.num_hidden_layers, map,
                             layout);
  }
  layout.begin_names_with("");
}

template <typename S>
void MaskedAutoregressiveFlow<S>::initialize(Parameters<S>& parameters, Stream& stream) const {
  initialize_dense(view(parameters, context_weight_), view(parameters, context_bias_), stream);
  for (const auto& transform : transforms_) transform.initialize(parameters, stream);
}

template <typename S>
std::unique_ptr<EstimatorScratch> MaskedAutoregressiveFlow<S>::make_scratch() const {
  auto scratch = std::make_unique<Scratch>();
  scratch->transforms.resize(transforms_.size());
  return scratch;
}

template <typename S>
void MaskedAutoregressiveFlow<S>::log_prob(const Parameters<S>& parameters, const RowMatrixX<S>& u,
                                           const RowMatrixX<S>& context, EstimatorScratch& base,
                                           VectorX<S>& log_prob) const {
  auto& scratch = static_cast<Scratch&>(base);
  dense(context, view(parameters, context_weight_), view(parameters, context_bias_),
        scratch.context);
  log_prob.setConstant(u.rows(), S(-0.5 * kLogTwoPi * static_cast<double>(dimension_)));
  scratch.z = u;
  for (Index k = 0; k < num_transforms(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    permute(scratch.z, order_[i], scratch.transforms[i].input);
    transforms_[i].forward(parameters,
                           scratch.context.middleCols(k * hidden_features(), hidden_features()),
                           scratch.transforms[i], scratch.z, log_prob);
  }
  log_prob -= S(0.5) * scratch.z.rowwise().squaredNorm();
}

template <typename S>
void MaskedAutoregressiveFlow<S>::backward(const Parameters<S>& parameters, const RowMatrixX<S>&,
                                           const RowMatrixX<S>& context,
                                           const VectorX<S>& d_log_prob, EstimatorScratch& base,
                                           Parameters<S>& gradient,
                                           RowMatrixX<S>* d_context) const {
  auto& scratch = static_cast<Scratch&>(base);
  scratch.d_context.resize(context.rows(), num_transforms() * hidden_features());
  scratch.d_z = -(scratch.z.array().colwise() * d_log_prob.array());
  for (Index k = num_transforms(); k-- > 0;) {
    const auto i = static_cast<std::size_t>(k);
    transforms_[i].backward(parameters, scratch.transforms[i], d_log_prob, scratch.d_z, gradient,
                            scratch.d_context.middleCols(k * hidden_features(), hidden_features()));
    permute_back(scratch.d_z, order_[i], scratch.permuted);
    scratch.d_z.swap(scratch.permuted);
  }
  dense_gradient(context, scratch.d_context, view(gradient, context_weight_),
                 view(gradient, context_bias_));
  if (d_context == nullptr) return;
  d_context->noalias() = scratch.d_context * view(parameters, context_weight_).transpose();
}

template <typename S>
RowMatrixX<S> MaskedAutoregressiveFlow<S>::sample(const Parameters<S>& parameters,
                                                  const RowMatrixX<S>& context, Index count,
                                                  const StreamId& id) const {
  ColumnMatrixX<S> z(count, dimension_);
  for (Index i = 0; i < z.rows(); ++i) {
    StreamId row = id;
    row.row += static_cast<std::uint64_t>(i);
    Stream stream(row);
    for (Index d = 0; d < dimension_; ++d) z(i, d) = static_cast<S>(stream.normal());
  }
  RowMatrixX<S> product;
  dense(context, view(parameters, context_weight_), view(parameters, context_bias_), product);
  ColumnMatrixX<S> next;
  for (Index k = num_transforms(); k-- > 0;) {
    const auto i = static_cast<std::size_t>(k);
    next = transforms_[i].inverse(parameters,
                                  product.middleCols(k * hidden_features(), hidden_features()), z);
    permute_back(next, order_[i], z);
  }
  return z;
}

template class MaskedAutoregressiveFlow<NPDR_SCALAR>;

}  // namespace npdr::inference
