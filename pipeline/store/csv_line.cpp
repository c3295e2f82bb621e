#include "pipeline/store/csv_line.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {

std::vector<std::string> csv_fields(const std::string& line, const std::string& where) {
  std::vector<std::string> fields(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool quote = line[i] == '"';
    if (inside && quote && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[i++];
    } else if (quote) {
      inside = !inside;
    } else if (line[i] == ',' && !inside) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  if (inside) {
    throw InputError(fmt::format("{}: column {} has no closing quote", where, fields.size()));
  }
  std::ranges::transform(fields, fields.begin(), trimmed);
  return fields;
}

}  // namespace npdr::pipeline
