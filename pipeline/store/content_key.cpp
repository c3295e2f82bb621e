#include "pipeline/store/content_key.h"

#include <cmath>

#include "core/error.h"
#include "core/text.h"
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

bool nests_deeply(const std::string& json) {
  constexpr int most = 500;
  int depth = 0;
  bool in_text = false, is_escaped = false;
  for (const char c : json) {
    if (is_escaped || (in_text && c == '\\')) {
      is_escaped = !is_escaped;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text) {
      depth += (c == '[' || c == '{') - (c == ']' || c == '}');
      if (depth > most) return true;
    }
  }
  return false;
}

nlohmann::ordered_json parse_json(const std::string& text, const std::string& where) {
  if (nests_deeply(text)) throw InputError(where + ": its JSON nests too deeply");
  auto json = nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) throw InputError(where + ": " + quoted(text) + " isn't JSON");
  return json;
}

}  // namespace npdr::pipeline
