#include "pipeline/sources/failed_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

// More than anybody reads of why a row failed.
constexpr std::uintmax_t kMostBytesARow = 4096;

void check_size(const std::filesystem::path& path, Index num_rows) {
  const std::uintmax_t size = std::filesystem::file_size(path);
  const std::uintmax_t most = kMostBytesARow * static_cast<std::uintmax_t>(num_rows);
  if (size <= most) return;
  throw InputError(fmt::format("NPDR_FAILED has {} bytes, must have {} of {} at most: a line a row",
                               size, most, counted(num_rows, "row")));
}

}  // namespace

std::map<Index, std::string> read_failed_rows(const std::filesystem::path& path, Index num_rows) {
  std::map<Index, std::string> rows;
  if (!std::filesystem::is_regular_file(path)) return rows;
  check_size(path, num_rows);
  std::ifstream stream(path, std::ios::binary);
  Index number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::size_t blank = std::min(line.find(' '), line.size());
    const std::optional<Index> row = parse_count(std::string_view(line).substr(0, blank));
    if (!row || *row >= num_rows || stream.eof()) {
      throw InputError(fmt::format(
          "NPDR_FAILED, line {} = {}, must be a row's number, 0 to {}, a blank, why it failed, and "
          "the end of the line",
          number, npdr::quoted(line), num_rows - 1));
    }
    const std::string why = trimmed(line.substr(blank));
    rows.emplace(*row, why.empty() ? "rows failed, and NPDR_FAILED doesn't say why" : why);
  }
  return rows;
}

}  // namespace npdr::pipeline
