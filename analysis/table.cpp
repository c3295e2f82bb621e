#include "analysis/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/file_stem.h"
#include "analysis/number_text.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// A finite number of a column, with the size of its last digit.
struct ShownNumber {
  std::size_t column;
  double value;
  double step;
};

std::vector<ShownNumber> compared_numbers(const Table& table, const Row& row) {
  std::vector<ShownNumber> numbers;
  const auto add = [&](std::size_t column, double value, double step) {
    if (std::isfinite(value)) numbers.push_back({column, value, step});
  };
  for (const std::size_t c : table.compared) {
    const Cell::Value& value = row.cells[c].value;
    if (const auto* number = std::get_if<double>(&value)) add(c, *number, last_digit(*number));
    if (const auto* count = std::get_if<Index>(&value)) add(c, static_cast<double>(*count), 0.0);
    const auto* mean = std::get_if<MeanStd>(&value);
    if (mean && std::isfinite(mean->mean)) add(c, mean->mean, last_digit(mean->mean, mean->std));
  }
  return numbers;
}

// How far a number that is rounded to `step` is from the best; less is better.
double loss_of(double value, double ideal, double step) {
  if (step > 0.0) value = step * std::round(value / step);
  return std::isinf(ideal) ? (ideal < 0.0 ? value : -value) : std::abs(value - ideal);
}

}  // namespace

void Table::add_footnote(const std::string& text) {
  if (std::ranges::find(footnotes, text) == footnotes.end()) footnotes.push_back(text);
}

bool Table::is_numeric(std::size_t column) const {
  return std::none_of(rows.begin(), rows.end(), [column](const Row& row) {
    return std::holds_alternative<std::string>(row.cells[column].value);
  });
}

std::vector<bool> Table::best_of(const Row& row) const {
  std::vector<bool> best(row.cells.size(), false);
  if (!row.ideal || compared.size() < 2) return best;
  const std::vector<ShownNumber> numbers = compared_numbers(*this, row);
  if (numbers.size() < 2) return best;
  const auto nearest = std::ranges::min_element(
      numbers, {}, [&](const ShownNumber& n) { return loss_of(n.value, *row.ideal, 0.0); });
  for (const ShownNumber& number : numbers) {
    const double step = std::max(number.step, nearest->step);
    best[number.column] = loss_of(number.value, *row.ideal, step) <=
                          loss_of(nearest->value, *row.ideal, step) + step / 2.0;
  }
  return best;
}

void Table::check() const {
  check_file_stem("table", name);
  for (const std::size_t column : compared) {
    if (column >= columns.size()) {
      throw ShapeError(
          fmt::format("table '{}' compares column {} of {}", name, column + 1, columns.size()));
    }
  }
  for (const Row& row : rows) {
    if (row.cells.size() != columns.size()) {
      throw ShapeError(fmt::format("table '{}': row '{}' has {} cells for {} columns", name,
                                   row.label, row.cells.size(), columns.size()));
    }
    for (const Cell& cell : row.cells) {
      for (const std::string& note : cell.notes) {
        if (std::ranges::find(footnotes, note) != footnotes.end()) continue;
        throw ShapeError(fmt::format("table '{}': row '{}' refers to '{}', which is no footnote",
                                     name, row.label, note));
      }
    }
  }
}

std::string footnote_mark(std::size_t index) {
  std::string mark(1, static_cast<char>('a' + index % 26));
  return index < 26 ? mark : footnote_mark(index / 26 - 1) + mark;
}

}  // namespace npdr::analysis
