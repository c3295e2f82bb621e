#include "pipeline/store/hostile_json.h"

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

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

}  // namespace

std::optional<nlohmann::ordered_json> json_in(const std::string& text) {
  if (nests_deeply(text)) return std::nullopt;
  auto json = nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

nlohmann::ordered_json parse_json(const std::string& text, const std::string& where) {
  auto json = json_in(text);
  if (json) return *std::move(json);
  throw InputError(
      where + ": " +
      (nests_deeply(text) ? "its JSON nests too deeply" : quoted(text) + " isn't JSON"));
}

}  // namespace npdr::pipeline
