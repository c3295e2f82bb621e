/// One masked autoregressive transform: the building block of autoregressive flows.
///
/// Source: Papamakarios, Pavlakou and Murray 2017, "Masked autoregressive flow for density
/// estimation", eqs. 3-6; masks as in Germain et al. 2015, "MADE". For u in R^D and context c
///   z_d = g(u_d; p_d),   p_d = p_d(u_1..u_{d-1}, c),     log |det dz/du| = sum_d log g'(u_d; p_d),
///   h_1 = tanh(u W_1 + c W_c + b_1),   h_l = tanh(h_{l-1} W_l + b_l),   p = h_L W_o + b_o,
/// with g an affine map or a spline (element_map.h). Hidden units are sorted by their degree
/// 0..D-1: a unit of degree g sees u_1..u_g (degree 0: the context alone, so that even z_1 depends
/// on the context).
#pragma once

#include <memory>
#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "inference/estimators/element_map.h"
#include "inference/estimators/parameters.h"

namespace npdr::inference {

/// Memory of a forward pass of one transform for the backward pass. m = n k rows; by columns, so
/// that the units of some degrees lie together.
template <typename S>
struct AutoregressiveScratch {
  ColumnMatrixX<S> input;                ///< (m, D)
  std::vector<ColumnMatrixX<S>> hidden;  ///< L x (m, hidden)
  ElementScratch<S> element;
  ColumnMatrixX<S> d_hidden;  ///< (m, hidden)
  ColumnMatrixX<S> d_below;   ///< (m, hidden)
};

template <typename S>
class AutoregressiveTransform {
 public:
  /// Takes its blocks from `layout`; `map` is g. The context product c W_c is computed by the
  /// owner, for all transforms at once.
  AutoregressiveTransform(Index dimension, Index hidden_features, Index num_hidden_layers,
                          std::shared_ptr<const ElementMap<S>> map, ParameterLayout& layout);

  Index hidden_features() const { return hidden_; }

  void initialize(Parameters<S>& parameters, Stream& stream) const;

  /// z(u) for u = scratch.input (m, D); `context` (n, hidden) holds c W_c + b_1; adds log |det| to
  /// `log_det` (m).
  void forward(const Parameters<S>& parameters, const Eigen::Ref<const RowMatrixX<S>>& context,
               AutoregressiveScratch<S>& scratch, ColumnMatrixX<S>& z, VectorX<S>& log_det) const;

  /// `d_z` holds dL/dz and becomes dL/du; d_log_det (m) is dL/dlog_det. Overwrites this transform's
  /// blocks of `gradient` and `d_context` (n, hidden).
  void backward(const Parameters<S>& parameters, AutoregressiveScratch<S>& scratch,
                const VectorX<S>& d_log_det, ColumnMatrixX<S>& d_z, Parameters<S>& gradient,
                Eigen::Ref<RowMatrixX<S>> d_context) const;

  /// u(z), (m, D), for one context (1, hidden) of all rows: one variable after the other, each
  /// hidden unit once. Products of matrices: a row's last bits may depend on m, so that callers
  /// take blocks of the same size.
  ColumnMatrixX<S> inverse(const Parameters<S>& parameters,
                           const Eigen::Ref<const RowMatrixX<S>>& context,
                           const ColumnMatrixX<S>& z) const;

 private:
  // Hidden units [begin, end) of whole degrees: they see no units of the layer below but [0, end),
  // and are seen by none of the layer above but [begin, hidden).
  struct UnitBlock {
    Index begin, end;
    Index size() const { return end - begin; }
  };

  /// First hidden unit of degree >= g; hidden_ for g = D.
  Index first_of_degree(Index g) const { return first_[static_cast<std::size_t>(g)]; }
  std::vector<UnitBlock> make_unit_blocks() const;
  // h_(l + 2) from h_(l + 1), and the way back: a block at a time, without the units that it
  // doesn't see.
  void hidden_forward(const Parameters<S>& parameters, std::size_t l,
                      AutoregressiveScratch<S>& scratch) const;
  void hidden_backward(const Parameters<S>& parameters, std::size_t l,
                       AutoregressiveScratch<S>& scratch, Parameters<S>& gradient) const;

  Index dimension_;
  Index hidden_;
  std::vector<Index> first_;            ///< D + 1
  std::vector<UnitBlock> unit_blocks_;  ///< a partition of the hidden units
  Block input_weight_;                  ///< (D, hidden)
  std::vector<Block> hidden_weight_;    ///< L - 1 x (hidden, hidden)
  std::vector<Block> hidden_bias_;      ///< L - 1 x (1, hidden)
  std::shared_ptr<const ElementMap<S>> map_;
  Block output_weight_;  ///< (hidden, P D)
  Block output_bias_;    ///< (1, P D)
  RowMatrixX<S> input_mask_;
  RowMatrixX<S> hidden_mask_;
  RowMatrixX<S> output_mask_;
};

}  // namespace npdr::inference
