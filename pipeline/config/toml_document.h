/// TOML text and command-line overrides as one JSON tree.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/reading.h"

namespace npdr::pipeline {

/// Parses a study's text, whose origin is the reading's, and sets values of it. Dates and times are
/// binary values that hold their text. Where keys stand, and problems of overrides, go to
/// `reading`. Throws InputError with the position of a syntax error.
///
/// An override is "dotted.key=value" with a TOML value; a bare word that isn't one counts as text.
/// A key below `method` applies to every method, or to the one that the next part of the key names:
/// method."NPDR (MAF)".num_rounds=2. Of target.recording and target.truth, the one that is set
/// removes the other, and a recording what the file says of the truth.
nlohmann::json read_toml(std::string_view text, const std::vector<std::string>& overrides,
                         Reading& reading);

}  // namespace npdr::pipeline
