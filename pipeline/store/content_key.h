/// Keys of artefacts: a hash of everything that an artefact depends on.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace npdr::pipeline {

/// The canonical text of a JSON document: members sorted by name, no white space, numbers with the
/// fewest digits that give back the same double. The order of a list counts, that of members
/// doesn't. Throws InputError for a number that isn't finite and for text that isn't UTF-8.
std::string canonical_json(const nlohmann::ordered_json& document);

/// 32 hexadecimal digits: XXH3-128 of the canonical text. Throws as canonical_json() does.
std::string content_key(const nlohmann::ordered_json& document);

}  // namespace npdr::pipeline
