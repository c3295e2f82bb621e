/// Values as they stand in datasets: arrays, row-major. Private to layout.h.
#pragma once

#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/store/h5.h"

namespace npdr::pipeline {

template <class T>
struct Array {
  using Element = T;
  h5::Shape shape;
  std::vector<T> values;
};

template <class T, int Rows, int Cols, int Order>
Array<T> pack(const Eigen::Matrix<T, Rows, Cols, Order>& matrix) {
  Array<T> array{{matrix.rows()}, std::vector<T>(static_cast<std::size_t>(matrix.size()))};
  if (Cols != 1) array.shape.push_back(matrix.cols());
  RowMatrixX<T>::Map(array.values.data(), matrix.rows(), matrix.cols()) = matrix;
  return array;
}
template <class T>
Array<T> pack(const std::vector<T>& values) {
  return {{static_cast<Index>(values.size())}, values};
}
inline Array<double> pack(double value) { return {{}, {value}}; }
/// Matrices of the same shape, in single precision.
Array<float> pack(const std::vector<RowMatrix>& matrices);

/// The inverse; dimensions before the last are one in a matrix.
template <class T, int Rows, int Cols, int Order>
void unpack(const Array<T>& array, Eigen::Matrix<T, Rows, Cols, Order>& matrix) {
  const Index cols = Cols == 1 ? 1 : array.shape.back();
  const Index rows = cols == 0 ? array.shape.front() : std::ssize(array.values) / cols;
  matrix = RowMatrixX<T>::Map(array.values.data(), rows, cols);
}
template <class T>
void unpack(const Array<T>& array, std::vector<T>& values) {
  values = array.values;
}
inline void unpack(const Array<double>& array, double& value) { value = array.values.front(); }
void unpack(const Array<float>& array, std::vector<RowMatrix>& matrices);

template <class V>
using ElementOf = typename decltype(pack(std::declval<V>()))::Element;

template <class T>
void write(h5::Dataset& dataset, const Array<T>& array) {
  if constexpr (std::is_same_v<T, std::string>) {
    dataset.write_texts(array.values);
  } else {
    dataset.write_rows<T>(0, dataset.num_rows(), std::span<const T>(array.values));
  }
}

/// Throws InputError.
template <class T>
Array<T> read(const h5::Dataset& dataset, h5::Values allowed) {
  if constexpr (std::is_same_v<T, std::string>) {
    return {dataset.shape(), dataset.read_texts()};
  } else {
    Array<T> array{dataset.shape(), dataset.read<T>()};
    if constexpr (std::is_floating_point_v<T>) {
      if (allowed == h5::Values::finite)
        dataset.require_finite<T>(std::span<const T>(array.values));
    }
    return array;
  }
}

/// Numbers that count are an Index in attributes.
template <class V, class Plain = std::remove_cvref_t<V>>
using StoredAttribute = std::conditional_t<std::is_integral_v<Plain>, Index, Plain>;

template <class T>
const char* element_name() {
  if (std::is_same_v<T, float>) return "float32";
  if (std::is_same_v<T, double>) return "float64";
  if (std::is_same_v<T, std::uint8_t>) return "uint8";
  return std::is_same_v<T, std::string> ? "texts" : "int64";
}
template <class V>
const char* attribute_name() {
  if (std::is_same_v<V, std::string>) return "text";
  if (std::is_same_v<V, std::vector<std::string>>) return "texts";
  return std::is_same_v<V, Index> ? "int64" : "float64";
}

}  // namespace npdr::pipeline
