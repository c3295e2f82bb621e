/// Readers of JSON that others wrote.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace npdr::pipeline {

/// `text` as JSON; nothing when it isn't, or nests so deeply that values, which are copied and
/// printed by recursion, could end this process.
std::optional<nlohmann::ordered_json> json_in(const std::string& text);

/// The same. Throws InputError, which begins with `where`, in place of nothing.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& where);

}  // namespace npdr::pipeline
