/// TOML values as the types of a study's fields. Private to pipeline/config.
///
/// read_value() returns false when the value is of another type, and leaves it to the caller to say
/// so. Tables whose keys are names of the user's own choice report what is wrong inside of them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/study.h"
#include "pipeline/config/toml_document.h"

namespace npdr::pipeline {

/// A node that is being read: the value, its dotted path and the reading it belongs to.
struct TomlSlot {
  const toml::node& node;
  std::string path;
  Reading& reading;
};

bool read_value(const TomlSlot& slot, bool& value);
bool read_value(const TomlSlot& slot, double& value);
bool read_value(const TomlSlot& slot, Index& value);
bool read_value(const TomlSlot& slot, std::uint64_t& value);
bool read_value(const TomlSlot& slot, std::string& value);
bool read_value(const TomlSlot& slot, std::vector<std::string>& value);
bool read_value(const TomlSlot& slot, std::vector<std::uint64_t>& value);
bool read_value(const TomlSlot& slot, std::vector<double>& value);
bool read_value(const TomlSlot& slot, std::vector<std::vector<double>>& value);
/// Numbers in tables of tables have the names of both: `a.b = 1` is "a.b".
bool read_value(const TomlSlot& slot, std::map<std::string, double>& value);
bool read_value(const TomlSlot& slot, std::map<std::string, std::string>& value);
bool read_value(const TomlSlot& slot, FreeTable& value);
bool read_value(const TomlSlot& slot, std::map<std::string, PublishedFigure>& value);
bool read_value(const TomlSlot& slot, std::vector<inference::Marginal>& value);

template <class T>
bool read_value(const TomlSlot& slot, std::optional<T>& value) {
  return read_value(slot, value.emplace());
}

/// The value as TOML on one line, shortened.
std::string found_text(const toml::node& node);

}  // namespace npdr::pipeline
