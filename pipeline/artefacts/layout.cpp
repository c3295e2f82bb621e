#include "pipeline/artefacts/layout.h"

#include <algorithm>
#include <cctype>

#include "core/text.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {

Array<float> pack(const std::vector<RowMatrix>& matrices) {
  const RowMatrix& first = matrices.front();
  Array<float> array{{std::ssize(matrices), first.rows(), first.cols()}, {}};
  for (const RowMatrix& matrix : matrices) {
    const Array<float> one = pack(RowMatrixF(matrix.cast<float>()));
    array.values.insert(array.values.end(), one.values.begin(), one.values.end());
  }
  return array;
}

void unpack(const Array<float>& array, std::vector<RowMatrix>& matrices) {
  const Index rows = array.shape[1], cols = array.shape[2];
  for (Index i = 0; i < array.shape[0]; ++i) {
    const float* values = array.values.data() + i * rows * cols;
    matrices.push_back(RowMatrixF::Map(values, rows, cols).cast<double>());
  }
}

void Layout::columns(const std::vector<Channel>& channels) {
  state_->rows.back().meaning += "; `labels`, `units`";
  if (out_ != nullptr) describe_columns(*dataset_, channels);
}

void Layout::columns(const std::vector<inference::Marginal>& prior) {
  std::vector<Channel> channels;
  std::vector<double> lower, upper;
  for (const inference::Marginal& marginal : prior) {
    channels.push_back({marginal.name, marginal.unit});
    lower.push_back(marginal.lower());
    upper.push_back(marginal.upper());
  }
  columns(channels);
  state_->rows.back().meaning += ", `prior_lower`, `prior_upper`";
  if (out_ == nullptr) return;
  dataset_->set_attribute("prior_lower", lower);
  dataset_->set_attribute("prior_upper", upper);
}

Layout Layout::group(const std::string& name) {
  Layout members = member(name);
  if (out_ != nullptr) {
    members.group_ = std::make_shared<h5::Group>(out_->create_group(name));
    members.out_ = members.group_.get();
  } else if (in_ != nullptr) {
    members.group_ = std::make_shared<h5::Group>(in_->group(name));
    members.in_ = members.group_.get();
  }
  return members;
}

std::vector<std::string> Layout::those_there(std::vector<std::string> names) const {
  if (in_ != nullptr) std::erase_if(names, [&](const auto& name) { return !in_->has(name); });
  return names;
}

Index Layout::num_values() const {
  Index count = 0;
  for (const std::string& name : in_->names()) {
    const h5::Dataset dataset = in_->dataset(name);
    dataset.require_readable(dataset.type());
    count += dataset.num_rows() * dataset.row_size();
  }
  return count;
}

Layout Layout::missing() {
  Layout nowhere = lister();
  nowhere.list("", {}, "");
  return nowhere;
}

Layout Layout::member(const std::string& name) const {
  Layout result = *this;
  result.path_ = path_.empty() ? name : path_ + "/" + name;
  return result;
}

void Layout::list(const char* type, const Dims& dims, const char* meaning) {
  std::vector<std::string> sizes;
  for (const Dim& dim : dims) sizes.emplace_back(dim.size);
  state_->rows.push_back({path_, type, "(" + join(sizes) + ")", meaning});
}

void Layout::create(const std::string& name, h5::ElementType type, const h5::Shape& shape,
                    const Dims& dims, const h5::Storage& storage,
                    const std::vector<h5::VirtualSource>& sources) {
  dataset_ = std::make_shared<h5::Dataset>(
      sources.empty() ? out_->create_dataset(name, type, shape, storage)
                      : out_->create_virtual_dataset(name, type, shape, sources));
  std::vector<std::string> labels;
  for (const Dim& dim : dims) labels.emplace_back(dim.label);
  if (!labels.empty() && !labels.front().empty()) dataset_->label_dimensions(labels);
}

void Layout::open(const std::string& name, const Dims& dims) {
  dataset_ = std::make_shared<h5::Dataset>(in_->dataset(name));
  h5::Shape expected;
  for (const Dim& dim : dims) {
    const auto known = state_->sizes.find(dim.size);
    const Index stated = std::isdigit(dim.size[0]) != 0 ? std::stoll(dim.size) : -1;
    expected.push_back(known == state_->sizes.end() ? stated : known->second);
  }
  dataset_->require_shape(expected);
  for (std::size_t d = 0; d < dims.size(); ++d) bind(dims[d].size, dataset_->shape()[d]);
}

}  // namespace npdr::pipeline
