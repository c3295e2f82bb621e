/// TOML text and command-line overrides as one tree. Private to pipeline/config: the only files
/// that see toml++ include this one.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>

#include "pipeline/config/problems.h"

namespace npdr::pipeline {

/// Parses a study's text. Throws InputError with the position of a syntax error; `origin` (a file
/// name) begins the message.
toml::table parse_toml(std::string_view text, const std::string& origin);

/// Sets one value of `document`. `assignment` is "dotted.key=value" with a TOML value; a bare word
/// that isn't one counts as text. A key below `method` applies to every method, or to the one that
/// the next part of the key names: method."NPDR (MAF)".num_rounds=2. Of target.recording and
/// target.truth, the one that is set removes the other, and a recording what the file says of the
/// truth. `number`: of the assignment among others, from 0, whose order new keys have. Problems go
/// to `reading`.
void apply_override(toml::table& document, const std::string& assignment, std::size_t number,
                    Reading& reading);

/// Where a key or value of the tree comes from; `origin` when toml++ has no record of it.
Place place_of(const toml::source_region& source, const std::string& origin);

/// True when the value was set on the command line.
bool is_override(const Place& place);

}  // namespace npdr::pipeline
