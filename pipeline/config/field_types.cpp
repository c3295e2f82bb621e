#include "pipeline/config/field_types.h"

#include <array>
#include <utility>

namespace npdr::pipeline {
namespace {

using Kind = inference::Marginal::Kind;

constexpr std::array<std::pair<Kind, const char*>, 4> kKinds = {{
    {Kind::uniform, "uniform"},
    {Kind::log_uniform, "log_uniform"},
    {Kind::normal, "normal"},
    {Kind::log_normal, "log_normal"},
}};

}  // namespace

std::optional<Kind> marginal_kind(const std::string& name) {
  for (const auto& [kind, known] : kKinds) {
    if (name == known) return kind;
  }
  return std::nullopt;
}

std::string marginal_kind_name(Kind kind) {
  for (const auto& [known, name] : kKinds) {
    if (kind == known) return name;
  }
  return "";
}

std::string marginal_words() {
  return "{ uniform = [low, high] }, { log_uniform = [low, high] }, { normal = [mean, std] } or "
         "{ log_normal = [mean of log, std of log] }";
}

}  // namespace npdr::pipeline
