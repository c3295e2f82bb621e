/// The types that fields of a study have, as people call them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

template <class T>
struct FieldType;

template <>
struct FieldType<bool> {
  static constexpr const char* kName = "true or false";
};
template <>
struct FieldType<double> {
  static constexpr const char* kName = "a finite number";
};
template <>
struct FieldType<Index> {
  static constexpr const char* kName = "an integer";
};
template <>
struct FieldType<std::uint64_t> {
  static constexpr const char* kName = "an integer";
};
template <>
struct FieldType<std::string> {
  static constexpr const char* kName = "text";
};
template <>
struct FieldType<std::vector<std::string>> {
  static constexpr const char* kName = "a list of texts";
};
template <>
struct FieldType<std::vector<std::uint64_t>> {
  static constexpr const char* kName = "a list of integers";
};
template <>
struct FieldType<std::vector<double>> {
  static constexpr const char* kName = "a list of finite numbers";
};
template <>
struct FieldType<std::vector<std::vector<double>>> {
  static constexpr const char* kName = "a list of lists of finite numbers";
};
template <>
struct FieldType<FreeTable> {
  static constexpr const char* kName = "a table";
};
template <>
struct FieldType<std::map<std::string, double>> {
  static constexpr const char* kName = "a table of finite numbers";
};
template <>
struct FieldType<std::map<std::string, std::string>> {
  static constexpr const char* kName = "a table of texts";
};
template <>
struct FieldType<std::map<std::string, PublishedFigure>> {
  static constexpr const char* kName = "a table of { mean, std }";
};
template <>
struct FieldType<std::vector<inference::Marginal>> {
  static constexpr const char* kName = "a table of distributions";
};
template <class T>
struct FieldType<std::optional<T>> : FieldType<T> {};

/// "an integer".
template <class T>
std::string type_name() {
  return FieldType<T>::kName;
}

/// "{ uniform = [low, high] }, ...": what a prior's entry must be.
std::string marginal_words();

}  // namespace npdr::pipeline
