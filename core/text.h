/// Small helpers for messages that people read.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace npdr {

/// The candidate with the smallest edit distance to `name` (Levenshtein, case folded), or "" when
/// none is near enough to be a likely misspelling. A candidate that begins with `name`, as 'npe_c'
/// with 'npe', is preferred to one with another letter, as 'nle'.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "a, b, c".
std::string join(const std::vector<std::string>& parts, std::string_view separator = ", ");

/// "a, b and c".
std::string listed(const std::vector<std::string>& names);

/// `text` without blanks and tabulators on both sides.
std::string trimmed(const std::string& text);

/// `text` with `to` in place of each `from`, which isn't empty, from left to right.
std::string replaced_all(std::string_view text, std::string_view from, std::string_view to);

/// "a:b" at ':' as "a", "b"; none for an empty text.
std::vector<std::string> split(const std::string& text, char separator);

/// A number that is not negative, in digits only; none for another text.
std::optional<Index> parse_count(std::string_view text);

/// "1 rollout", "2 rollouts".
std::string counted(Index count, std::string_view noun);

/// 0, 2, 3, 4, 9 as "0,2-4,9"; ascending.
std::string index_ranges(const std::vector<Index>& indices);

/// `unknown simulator 'furta' (did you mean 'furuta'?); known: furuta, pendulum`.
std::string unknown_name(std::string_view kind, std::string_view name,
                         const std::vector<std::string>& known);

/// `has no column 'thet' (did you mean 'theta'?); it has t, theta`.
std::string missing_name(std::string_view kind, std::string_view name,
                         const std::vector<std::string>& present);

/// `text` in quotes; a long one is cut, so that a message stays readable.
std::string quoted(const std::string& text);
/// At most about 60 bytes of `text`, control characters replaced by '?'.
std::string shortened(const std::string& text);

/// `key = found, must be words`, with the nearest of `names` when there are any.
std::string must_be(const std::string& key, const std::string& found, const std::string& words,
                    const std::vector<std::string>& names = {});

}  // namespace npdr
