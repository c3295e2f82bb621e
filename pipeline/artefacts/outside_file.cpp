#include "pipeline/artefacts/outside_file.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostAtOnce = 4096;  // rows that are read together
// How far apart rows may lie that are read at once: what lies between is faster read than skipped.
constexpr Index kNear = 16;

// Rows of a file by their positions in it, in another order of theirs.
struct RowOrder {
  std::span<const Index> rows;
  std::vector<std::size_t> ascending;  // of them

  explicit RowOrder(std::span<const Index> given) : rows(given), ascending(given.size()) {
    std::iota(ascending.begin(), ascending.end(), std::size_t{0});
    std::ranges::sort(ascending, {}, [&](std::size_t i) { return rows[i]; });
  }
  Index at(std::size_t k) const { return rows[ascending[k]]; }
  // One past those from the `begin`th on that are read at once.
  std::size_t end_of_block(std::size_t begin) const {
    std::size_t end = begin + 1;
    while (end < ascending.size() && at(end) - at(end - 1) <= kNear &&
           at(end) - at(begin) < kMostAtOnce)
      ++end;
    return end;
  }
};

}  // namespace

h5::Dataset own_dataset(const h5::Group& group, const std::string& name) {
  h5::Dataset dataset = group.dataset(name);
  if (dataset.part_files().empty()) return dataset;
  throw InputError(dataset.where() + ": its rows lie in other files, must be in this one");
}

std::vector<Index> all_columns(Index count) {
  std::vector<Index> columns(static_cast<std::size_t>(count));
  std::iota(columns.begin(), columns.end(), Index{0});
  return columns;
}

RowMatrix read_rows_at(const h5::Dataset& dataset, std::span<const Index> rows,
                       const std::vector<Index>& columns) {
  RowMatrix picked(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  const RowOrder order(rows);
  RowMatrix block;
  for (std::size_t k = 0; k < rows.size();) {
    const std::size_t end = order.end_of_block(k);
    const Index begin = order.at(k), count = order.at(end - 1) + 1 - begin;
    block.resize(count, dataset.row_size());
    dataset.read_rows<double>(begin, count, {block.data(), static_cast<std::size_t>(block.size())});
    for (; k < end; ++k) {
      picked.row(static_cast<Index>(order.ascending[k])) = block(order.at(k) - begin, columns);
    }
  }
  return picked;
}

}  // namespace npdr::pipeline
