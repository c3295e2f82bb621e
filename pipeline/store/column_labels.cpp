#include "pipeline/store/column_labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>
#include <unordered_set>

#include "core/error.h"
#include "core/feature_names.h"
#include "core/printable.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

// One text a column; none where there is no such attribute. Names and units go on to terminals,
// tables and keys.
std::vector<std::string> column_texts(const h5::Dataset& dataset, const char* attribute,
                                      Index num_columns) {
  if (!dataset.has_attribute(attribute)) return {};
  auto texts = dataset.attribute<std::vector<std::string>>(attribute);
  if (std::ssize(texts) != num_columns) {
    throw InputError(fmt::format("{} has {} columns, but {} {}", dataset.where(), num_columns,
                                 texts.size(), attribute));
  }
  std::ranges::transform(texts, texts.begin(), printable_line);
  return texts;
}

void require_distinct(const h5::Dataset& dataset, const std::vector<std::string>& labels) {
  std::unordered_set<std::string> known;  // of a million, too
  for (const std::string& label : labels) {
    if (label.empty()) {
      throw InputError(fmt::format("{}: label {} is empty", dataset.where(), known.size() + 1));
    }
    if (!known.insert(label).second) {
      throw InputError(
          fmt::format("{}: two columns have the label '{}'", dataset.where(), shortened(label)));
    }
  }
}

}  // namespace

std::vector<std::string> column_labels(const h5::Dataset& dataset, Index num_columns) {
  const std::vector<std::string> labels = column_texts(dataset, "labels", num_columns);
  require_distinct(dataset, labels);
  return labels;
}

std::vector<Channel> column_channels(const h5::Dataset& dataset, Index num_columns) {
  std::vector<Channel> channels = parse_features(column_labels(dataset, num_columns));
  require_distinct(dataset, labels_of(channels));  // without their units
  const std::vector<std::string> units = column_texts(dataset, "units", num_columns);
  for (std::size_t c = 0; c < std::min(units.size(), channels.size()); ++c) {
    channels[c].unit = units[c];
  }
  return channels;
}

void describe_columns(h5::Dataset& dataset, const std::vector<Channel>& columns) {
  std::vector<std::string> units;
  for (const Channel& column : columns) units.push_back(column.unit);
  dataset.set_attribute("labels", labels_of(columns));
  dataset.set_attribute("units", units);
}

std::vector<std::string> labels_of(const std::vector<Channel>& columns) {
  std::vector<std::string> labels;
  for (const Channel& column : columns) labels.push_back(column.label);
  return labels;
}

std::vector<std::string> few_shortened(const std::vector<std::string>& names) {
  constexpr std::size_t most = 10;
  std::vector<std::string> few;
  for (const std::string& name : names | std::views::take(most)) few.push_back(shortened(name));
  if (names.size() > most) few.push_back(fmt::format("and {} more", names.size() - most));
  return few;
}

}  // namespace npdr::pipeline
