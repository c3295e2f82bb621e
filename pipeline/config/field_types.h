/// The types that fields of a study have, as people call them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// "an integer", for a null pointer to the type.
inline const char* type_of(const bool*) { return "true or false"; }
inline const char* type_of(const double*) { return "a finite number"; }
inline const char* type_of(const Index*) { return "an integer"; }
inline const char* type_of(const std::uint64_t*) { return "an integer"; }
inline const char* type_of(const std::string*) { return "text"; }
inline const char* type_of(const std::vector<std::string>*) { return "a list of texts"; }
inline const char* type_of(const std::vector<std::uint64_t>*) { return "a list of integers"; }
inline const char* type_of(const std::vector<double>*) { return "a list of finite numbers"; }
inline const char* type_of(const std::vector<std::vector<double>>*) {
  return "a list of lists of finite numbers";
}
inline const char* type_of(const FreeTable*) { return "a table"; }
inline const char* type_of(const std::map<std::string, double>*) {
  return "a table of finite numbers";
}
inline const char* type_of(const std::map<std::string, std::string>*) { return "a table of texts"; }
inline const char* type_of(const std::map<std::string, PublishedFigure>*) {
  return "a table of { mean, std }";
}
inline const char* type_of(const std::vector<inference::Marginal>*) {
  return "a table of distributions";
}
template <class T>
const char* type_of(const std::optional<T>*) {
  return type_of(static_cast<const T*>(nullptr));
}

/// "an integer".
template <class T>
std::string type_name() {
  return type_of(static_cast<const T*>(nullptr));
}

/// "{ uniform = [low, high] }, ...": what a prior's entry must be.
inline std::string marginal_words() {
  return "{ uniform = [low, high] }, { log_uniform = [low, high] }, { normal = [mean, std] } or "
         "{ log_normal = [mean of log, std of log] }, of finite numbers";
}

}  // namespace npdr::pipeline
