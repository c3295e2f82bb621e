#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/escape.h"
#include "analysis/table_writers.h"

namespace npdr::analysis {
namespace {

std::string number_csv(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

bool has_means(const Table& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(), [column](const Row& row) {
    return std::holds_alternative<MeanStd>(row.cells[column].value);
  });
}

std::string cell_csv(const Cell& cell, bool three_columns) {
  if (const auto* mean_std = std::get_if<MeanStd>(&cell.value)) {
    return fmt::format(",{},{},{}", number_csv(mean_std->mean), number_csv(mean_std->std),
                       mean_std->n > 0 ? std::to_string(mean_std->n) : "");
  }
  std::string text = ",";
  if (const auto* words = std::get_if<std::string>(&cell.value)) text += quote_csv(*words);
  if (const auto* number = std::get_if<double>(&cell.value)) text += number_csv(*number);
  if (const auto* count = std::get_if<Index>(&cell.value)) text += std::to_string(*count);
  return three_columns ? text + ",," : text;
}

}  // namespace

std::string to_csv(const Table& table) {
  table.check();
  std::string text = quote_csv(table.row_header);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string& title = table.columns[c];
    if (has_means(table, c)) {
      for (const char* part : {" mean", " std", " n"}) text += ',' + quote_csv(title + part);
    } else {
      text += ',' + quote_csv(title);
    }
  }
  text += '\n';
  for (const Row& row : table.rows) {
    text += quote_csv(row.label);
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      text += cell_csv(row.cells[c], has_means(table, c));
    }
    text += '\n';
  }
  return text;
}

}  // namespace npdr::analysis
