#include "core/feature_names.h"

#include <fmt/format.h>

#include "core/text.h"

namespace npdr {
namespace {

constexpr const char* kNoUnit = "1";

}  // namespace

Channel parse_channel(const std::string& text) {
  const std::size_t open = text.rfind('[');
  const bool has_unit = open != std::string::npos && open > 0 && text[open - 1] == ' ';
  if (!has_unit || text.back() != ']') return {text, ""};
  return {trimmed(text.substr(0, open)), trimmed(text.substr(open + 1, text.size() - open - 2))};
}

Channel parse_feature(const std::string& name) {
  Channel feature = parse_channel(name);
  if (feature.unit.empty()) feature.unit = kNoUnit;
  return feature;
}

std::vector<Channel> parse_features(const std::vector<std::string>& names) {
  std::vector<Channel> features;
  for (const std::string& name : names) features.push_back(parse_feature(name));
  return features;
}

std::string feature_name(const Channel& feature) {
  return feature.unit == kNoUnit ? feature.label
                                 : fmt::format("{} [{}]", feature.label, feature.unit);
}

std::vector<std::string> feature_names(const std::vector<Channel>& features) {
  std::vector<std::string> names;
  for (const Channel& feature : features) names.push_back(feature_name(feature));
  return names;
}

std::vector<Channel> numbered_features(Index count) {
  std::vector<Channel> features;
  for (Index f = 0; f < count; ++f) features.push_back({fmt::format("x{}", f), kNoUnit});
  return features;
}

}  // namespace npdr
