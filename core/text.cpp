#include "core/text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <numeric>
#include <sstream>

namespace npdr {
namespace {

bool is_control(char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; }

char fold(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (fold(a[i - 1]) == fold(b[j - 1]) ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substitute, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

bool begins_with(std::string_view text, std::string_view beginning) {
  return std::ranges::equal(text.substr(0, beginning.size()), beginning, {}, fold, fold);
}

// The first candidate that begins with `name`: "npe_c" with "npe". "" when there is none.
std::string beginning_with(std::string_view name, const std::vector<std::string>& candidates) {
  constexpr std::size_t kFew = 3;  // letters that many names begin with by chance
  if (name.size() < kFew) return "";
  const auto found = std::ranges::find_if(
      candidates, [&](const std::string& candidate) { return begins_with(candidate, name); });
  return found == candidates.end() ? "" : *found;
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  // As far as a typing error or two, and no name in which no letter is the same.
  std::size_t best_distance = std::min(std::max<std::size_t>(2, name.size() / 3) + 1, name.size());
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  if (!best.empty() && (begins_with(best, name) || begins_with(name, best))) return best;
  const std::string whole = beginning_with(name, candidates);
  return whole.empty() ? best : whole;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
  std::string joined;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) joined += separator;
    joined += parts[i];
  }
  return joined;
}

std::string listed(const std::vector<std::string>& names) {
  if (names.size() < 2) return join(names);
  return join({names.begin(), names.end() - 1}) + " and " + names.back();
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::string replaced_all(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  std::size_t begin = 0;
  for (std::size_t at = text.find(from); at != std::string_view::npos;
       at = text.find(from, begin)) {
    result.append(text.substr(begin, at - begin)).append(to);
    begin = at + from.size();
  }
  return result.append(text.substr(begin));
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

std::optional<Index> parse_count(std::string_view text) {
  if (text.starts_with('-')) return std::nullopt;
  Index value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

namespace {

// "column 'thet' (did you mean 'theta'?)"
std::string with_guess(std::string_view kind, std::string_view name,
                       const std::vector<std::string>& known) {
  std::string text = std::string(kind) + " '" + std::string(name) + "'";
  const std::string guess = nearest_name(name, known);
  if (!guess.empty() && guess != name) text += " (did you mean '" + guess + "'?)";
  return text;
}

}  // namespace

std::string unknown_name(std::string_view kind, std::string_view name,
                         const std::vector<std::string>& known) {
  return "unknown " + with_guess(kind, name, known) +
         (known.empty() ? "; there is none" : "; known: " + join(known));
}

std::string missing_name(std::string_view kind, std::string_view name,
                         const std::vector<std::string>& present) {
  return "has no " + with_guess(kind, name, present) + "; it has " +
         (present.empty() ? "nothing" : join(present));
}

std::string counted(Index count, std::string_view noun) {
  return std::to_string(count).append(" ").append(noun).append(count == 1 ? "" : "s");
}

std::string index_ranges(const std::vector<Index>& indices) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0; i < indices.size();) {
    std::size_t last = i;
    while (last + 1 < indices.size() && indices[last + 1] == indices[last] + 1) ++last;
    std::string range = std::to_string(indices[i]);
    if (last > i) range.append("-").append(std::to_string(indices[last]));
    ranges.push_back(range);
    i = last + 1;
  }
  return join(ranges, ",");
}

std::string must_be(const std::string& key, const std::string& found, const std::string& words,
                    const std::vector<std::string>& names) {
  std::string message = key + " = " + found + ", must be " + words;
  std::string bare = found;
  std::erase(bare, '\'');
  const std::string guess = nearest_name(bare, names);
  if (!guess.empty()) message += " (did you mean '" + guess + "'?)";
  return message;
}

std::string quoted(const std::string& text) { return "'" + shortened(text) + "'"; }

std::string shortened(const std::string& text) {
  constexpr std::size_t limit = 60;
  std::string result = text.substr(0, limit);
  std::replace_if(result.begin(), result.end(), is_control, '?');
  if (text.size() <= limit) return result;
  // A cut UTF-8 sequence would spoil the terminal's line: drop its beginning too.
  while (!result.empty() && (static_cast<unsigned char>(result.back()) & 0xC0) == 0x80) {
    result.pop_back();
  }
  if (!result.empty() && (static_cast<unsigned char>(result.back()) & 0x80) != 0) result.pop_back();
  return result + "...";
}

}  // namespace npdr
