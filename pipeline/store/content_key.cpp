#include "pipeline/store/content_key.h"

#include <cmath>

#include "core/error.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

// JSON would write null for all of them, so that different documents would share a key.
void require_finite(const nlohmann::ordered_json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    throw InputError("a key document holds a number that isn't finite");
  }
  if (!value.is_structured()) return;
  for (const nlohmann::ordered_json& member : value) require_finite(member);
}

}  // namespace

std::string canonical_json(const nlohmann::ordered_json& document) {
  require_finite(document);
  try {
    return nlohmann::json(document).dump();  // nlohmann::json sorts members
  } catch (const nlohmann::json::type_error& error) {
    throw InputError(std::string("a key document holds text that isn't UTF-8: ") + error.what());
  }
}

std::string content_key(const nlohmann::ordered_json& document) {
  const std::string text = canonical_json(document);
  Hasher hasher;
  hasher.add_bytes(text.data(), text.size());
  return hasher.hex();
}

}  // namespace npdr::pipeline
