/// The layout of every artefact, described once. A function describe(Layout, value) says of all
/// that stands in a file, in the order in which it is read, its name, its place in memory, what its
/// dimensions count and what it means; the Layout writes, reads or lists it (docs/file-formats.md).
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/target.h"
#include "inference/prior.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// Values as they stand in datasets: arrays, row-major.
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

/// Numbers that count are an Index in attributes.
template <class V, class Plain = std::remove_cvref_t<V>>
using StoredAttribute = std::conditional_t<std::is_integral_v<Plain>, Index, Plain>;

template <class T>
const char* element_name() {
  constexpr std::array names = {"float32", "float64", "uint8", "int64", "texts"};
  return names.at(static_cast<std::size_t>(h5::element_type<T>()));
}
template <class V>
const char* attribute_name() {
  if (std::is_same_v<V, std::string>) return "text";
  if (std::is_same_v<V, std::vector<std::string>>) return "texts";
  return std::is_same_v<V, Index> ? "int64" : "float64";
}

/// A dimension of a dataset.
struct Dim {
  /// Its name in tables, the same number wherever it isn't forgotten; or that number itself.
  const char* size;
  const char* label = "";  ///< HDF5's label: what it counts; all or none of a dataset's have one
};
using Dims = std::vector<Dim>;

inline constexpr Dim kRow{"n", "row"};
inline constexpr Dim kParameter{"D", "parameter"};
inline constexpr Dim kFeature{"F", "feature"};

struct DatasetOptions {
  h5::Values allowed = h5::Values::any;  ///< in files that are read
  bool unless_empty = false;             ///< missing where there is nothing in it
  h5::Storage storage = {};
  h5::Shape shape = {};  ///< in the file; empty: the value's own
};
inline const DatasetOptions kFinite{.allowed = h5::Values::finite};
/// Hardly compresses, so the fastest level is the best one.
inline constexpr h5::Storage kFastest{.chunked = true, .deflate = 1};

/// A row of a table: the dataset `a/b`, or the attribute `a@b` of a.
struct LayoutRow {
  std::string path, type, shape, meaning;
};

/// A group or a dataset whose content is described. Reading throws InputError for what is missing
/// or of another type, and for sizes that don't go together; writing throws Error. Copies share
/// their state: a name of a size means the same in all parts of an artefact, unless forget() ends
/// that.
class Layout {
 public:
  static Layout writer(h5::Group& group) { return {&group, nullptr}; }
  static Layout reader(const h5::Group& group) { return {nullptr, &group}; }
  static Layout lister() { return {nullptr, nullptr}; }

  bool reads() const { return in_ != nullptr; }
  bool writes() const { return out_ != nullptr; }
  bool lists() const { return !reads() && !writes(); }
  /// How messages call a group that is read.
  const std::string& where() const { return in_->where(); }
  const std::vector<LayoutRow>& rows() const { return state_->rows; }

  /// A dataset. Attributes and columns of what is returned are its own.
  template <class V>
  Layout operator()(const std::string& name, V&& value, const Dims& dims, const char* meaning,
                    const DatasetOptions& options = {}) {
    using T = ElementOf<V>;
    Layout dataset = member(name);
    dataset.list(element_name<T>(), dims, meaning);
    if (out_ != nullptr) {
      const Array<T> array = pack(value);
      if (options.unless_empty && array.values.empty()) return missing();
      dataset.create(name, h5::element_type<T>(),
                     options.shape.empty() ? array.shape : options.shape, dims, options.storage);
      dataset.dataset_->write(array.values);
    } else if (in_ != nullptr) {
      if (options.unless_empty && !in_->has(name)) return missing();
      dataset.open(name, dims);
      const h5::Dataset& stored = *dataset.dataset_;
      unpack(Array<T>{stored.shape(), stored.template read<T>(options.allowed)}, value);
    }
    return dataset;
  }
  /// The same of one that may be missing.
  template <class V>
  Layout operator()(const std::string& name, std::optional<V>& value, const Dims& dims,
                    const char* meaning, const DatasetOptions& options = {}) {
    return is_there(name, value) ? (*this)(name, *value, dims, meaning, options) : missing();
  }
  /// A dataset for each entry of a map: those of `names` are read.
  template <class V>
  void each(std::map<std::string, V>& values, const std::vector<std::string>& names,
            const Dims& dims, const char* meaning) {
    if (in_ != nullptr) {
      for (const std::string& name : names) values[name];
    } else if (out_ == nullptr) {
      (*this)(names.front() + ", ...", V(), dims, meaning);
    }
    for (auto& [name, value] : values) (*this)(name, value, dims, meaning);
  }
  /// A dataset whose rows are written later or, where there are `sources`, are those of other
  /// files.
  template <class T>
  Layout rows_later(const std::string& name, const h5::Shape& shape, const Dims& dims,
                    const char* meaning, const h5::Storage& storage = {},
                    const std::vector<h5::VirtualSource>& sources = {}) {
    Layout dataset = member(name);
    dataset.list(element_name<T>(), dims, meaning);
    if (out_ != nullptr) dataset.create(name, h5::element_type<T>(), shape, dims, storage, sources);
    return dataset;
  }

  /// Names and units of a dataset's columns, for people; those of a prior with its bounds.
  void columns(const std::vector<Channel>& channels);
  void columns(const std::vector<inference::Marginal>& prior);

  /// An attribute of the group or dataset.
  template <class V>
  void attribute(const std::string& name, V&& value, const char* meaning) {
    using Stored = StoredAttribute<V>;
    if (out_ != nullptr) {
      (dataset_ ? static_cast<h5::Object&>(*dataset_) : *out_)
          .set_attribute(name, static_cast<Stored>(value));
    } else if (in_ != nullptr) {
      const h5::Object& object = dataset_ ? static_cast<const h5::Object&>(*dataset_) : *in_;
      value = static_cast<std::remove_cvref_t<V>>(object.attribute<Stored>(name));
    }
    state_->rows.push_back({path_ + "@" + name, attribute_name<Stored>(), "", meaning});
  }

  Layout group(const std::string& name);
  /// The same of one that may be missing.
  template <class V>
  std::optional<Layout> group(const std::string& name, std::optional<V>& value) {
    return is_there(name, value) ? std::optional(group(name)) : std::nullopt;
  }

  /// How many values the datasets of a group that is read hold, whatever they are.
  Index num_values() const;
  /// Those of the names that a file has which is read; else all.
  std::vector<std::string> those_there(std::vector<std::string> names) const;
  /// Makes a size known that a file that is read says elsewhere.
  void bind(const char* size, Index value) { state_->sizes[size] = value; }
  /// The next dataset says anew how large a size is: it counts something else in each group.
  void forget(const char* size) { state_->sizes.erase(size); }

 private:
  struct State {
    std::map<std::string, Index> sizes;
    std::vector<LayoutRow> rows;
  };

  Layout(h5::Group* out, const h5::Group* in)
      : out_(out), in_(in), state_(std::make_shared<State>()) {}

  template <class V>
  bool is_there(const std::string& name, std::optional<V>& value) const {
    if (in_ != nullptr ? in_->has(name) : out_ == nullptr) value.emplace();
    return value.has_value();
  }
  static Layout missing();
  Layout member(const std::string& name) const;
  void list(const char* type, const Dims& dims, const char* meaning);
  void create(const std::string& name, h5::ElementType type, const h5::Shape& shape,
              const Dims& dims, const h5::Storage& storage,
              const std::vector<h5::VirtualSource>& sources = {});
  void open(const std::string& name, const Dims& dims);

  h5::Group* out_;       // that is written, or
  const h5::Group* in_;  // that is read, or neither
  std::shared_ptr<State> state_;
  std::string path_;
  std::shared_ptr<h5::Group> group_;      // of out_ or in_, but for the outermost
  std::shared_ptr<h5::Dataset> dataset_;  // none: this is a group
};

/// A part of a file that may be missing, by describe(Layout, std::optional<T>&). Throws Error.
template <class T>
void write_part(h5::Group& file, const T& value) {
  std::optional part(value);  // of an optional: a copy
  describe(Layout::writer(file), part);
}
/// Throws InputError.
template <class T>
std::optional<T> read_part(const h5::Group& file) {
  std::optional<T> part;
  describe(Layout::reader(file), part);
  return part;
}

/// Each describes artefacts, or parts of them, that aren't read and written as a whole (schemas.h),
/// and is defined beside its layout.
void list_observation(Layout f);
void list_target(Layout f);
void list_simulation(Layout f);
void list_posterior(Layout f);
void list_flow(Layout f);
void list_mixture(Layout f);
void list_ratio_network(Layout f);
void list_particles(Layout f);
void list_certificate(Layout f);

std::vector<std::string> layout_names();

/// Markdown. Throws InputError for an unknown name.
std::string layout_table(const std::string& name);

}  // namespace npdr::pipeline
