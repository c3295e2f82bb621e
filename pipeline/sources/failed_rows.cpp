#include "pipeline/sources/failed_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

constexpr std::size_t kMostOfARow = 1000;  // more than anybody reads

[[noreturn]] void fail(const std::string& why) { throw InputError("NPDR_FAILED " + why); }

}  // namespace

std::map<Index, std::string> read_failed_rows(const std::filesystem::path& path, Index num_rows) {
  std::map<Index, std::string> rows;
  std::error_code error;
  const auto type = std::filesystem::symlink_status(path, error).type();
  if (type == std::filesystem::file_type::not_found) return rows;
  if (type != std::filesystem::file_type::regular) fail("must be a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail("can't be read");
  Index number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    const std::size_t blank = std::min(line.find_first_of(" \t"), line.size());
    const std::optional<Index> row = parse_count(std::string_view(line).substr(0, blank));
    // A file that was cut may end in the middle of a number.
    const bool is_cut = stream.eof() && blank == line.size();
    if (!row || *row >= num_rows || is_cut) {
      fail(
          fmt::format("has in line {} {}, must have a row's number, 0 to {}, a blank, why it "
                      "failed, and the line's end",
                      number, npdr::quoted(line), num_rows - 1));
    }
    const std::string why = trimmed(line.substr(blank, kMostOfARow));
    rows.emplace(*row, why.empty() ? "it failed, and NPDR_FAILED doesn't say why" : why);
  }
  if (stream.bad()) fail("can't be read to its end");
  return rows;
}

}  // namespace npdr::pipeline
