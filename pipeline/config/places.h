/// Where the values of a study stand, for messages.
#pragma once

#include <map>
#include <string>

namespace npdr::pipeline {

/// A file's line and column (counted from 1), or a command-line override.
struct Place {
  std::string origin;  ///< file name, or "--set key=value"
  int line = 0;        ///< 0: the origin as a whole
  int column = 0;

  /// "study.toml:14:9".
  std::string str() const;
  /// Whether it is one of the command line.
  bool is_override() const;
};

/// Begins the origin of overrides.
inline constexpr const char* kOverride = "--set ";

/// A key of a text, and its value.
struct KeySource {
  Place key, value;
  int line = 0, column = 0;  ///< of the key, of overrides among each other
};

/// The places of a study's keys. Keys are dotted paths with the position in a list, such as
/// "method[0].training.batch_size".
class Places {
 public:
  /// `origin`: what the study was read from.
  explicit Places(std::string origin = "study") : origin_(std::move(origin)) {}

  void add(const std::string& path, const Place& place) { places_[path] = place; }
  bool has(const std::string& path) const { return places_.contains(path); }

  /// Where `path` stands; for a table that only overrides mention, where the first of its keys
  /// stands; for a key that was left out, where its table stands.
  Place of(const std::string& path) const;

  const std::string& origin() const { return origin_; }

 private:
  std::string origin_;
  std::map<std::string, Place> places_;
};

}  // namespace npdr::pipeline
