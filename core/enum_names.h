/// Names of an enumeration's values: what people write in files and read in messages.
///
/// An enumeration has names where enum_table(E), declared beside it, returns its rows in the order
/// in which they are documented:
///   enum class Shape { square, disk };
///   constexpr auto enum_table(Shape) {
///     return std::to_array<EnumRow<Shape>>(
///         {{Shape::square, "square"}, {Shape::disk, "disk", "circle ball"}});
///   }
/// Every value has one row. A value whose name is empty stands for nothing: it can be written and
/// read, but no list shows it.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/error.h"
#include "core/text.h"

namespace npdr {

template <class E>
struct EnumRow {
  E value;
  std::string_view name;
  std::string_view other_spellings = {};  ///< read as well, never written: "circle ball"
};

template <class E>
concept NamedEnum = std::is_enum_v<E> && requires(E value) {
  enum_table(value);
};

/// Whether an enumeration has this value: compilers write others as "(Shape)3".
template <auto value>
constexpr bool is_enumerator() {
  const std::string_view text = __PRETTY_FUNCTION__;
  const char next = text[text.rfind(')') + 1];
  return next < '0' || next > '9';
}

/// Whether row i of a table is that of value i.
constexpr bool is_in_order(const auto& table) {
  return std::ranges::all_of(
      table, [&](const auto& row) { return &row == &table[static_cast<std::size_t>(row.value)]; });
}

/// The row of a value, of a table that has one for each in their order.
template <NamedEnum E>
constexpr auto row_of(E value) {
  constexpr auto table = enum_table(E{});
  static_assert(is_in_order(table), "row i must be that of value i");
  static_assert(!is_enumerator<static_cast<E>(table.size())>(), "the last value has no row");
  return table[static_cast<std::size_t>(value)];
}

template <NamedEnum E>
std::string name_of(E value) {
  const auto& table = enum_table(value);
  return std::string(std::ranges::find(table, value, &EnumRow<E>::value)->name);
}

/// The names that lists show, in their documented order.
template <NamedEnum E>
std::vector<std::string> names_of() {
  std::vector<std::string> names;
  for (const auto& row : enum_table(E{})) {
    if (!row.name.empty()) names.emplace_back(row.name);
  }
  return names;
}

/// All values, in the same order.
template <NamedEnum E>
std::vector<E> values_of() {
  std::vector<E> values;
  for (const auto& row : enum_table(E{})) values.push_back(row.value);
  return values;
}

template <NamedEnum E>
std::vector<std::string> to_names(const std::vector<E>& values) {
  std::vector<std::string> names;
  for (const E value : values) names.push_back(name_of(value));
  return names;
}

/// The value of that name or other spelling; none for an unknown one.
template <NamedEnum E>
std::optional<E> value_named(std::string_view name) {
  for (const auto& row : enum_table(E{})) {
    if (row.name == name) return row.value;
    for (const std::string& spelling : split(std::string(row.other_spellings), ' ')) {
      if (spelling == name) return row.value;
    }
  }
  return std::nullopt;
}

/// The value of that name or other spelling. Throws InputError with the nearest known name:
/// "unknown `kind` 'crcle' (did you mean 'circle'?); known: ...".
template <NamedEnum E>
E parse_enum(std::string_view kind, std::string_view name) {
  if (const auto value = value_named<E>(name)) return *value;
  throw InputError(unknown_name(kind, name, names_of<E>()));
}

}  // namespace npdr
