/// Places of a study's values, for messages, and problems of these values.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/text.h"

namespace npdr::pipeline {

/// A file's line and column (counted from 1), or a command-line override.
struct Place {
  std::string origin;  ///< file name, or "--set key=value"
  int line = 0;        ///< 0: the origin as a whole; of overrides among each other
  int column = 0;

  /// "study.toml:14:9".
  std::string str() const;
  /// Whether it is one of the command line.
  bool is_override() const;
};

/// Begins the origin of overrides.
inline constexpr const char* kOverride = "--set ";

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

/// "method[0].training" as people write it: "method.training".
std::string display(const std::string& path);

/// A key of a text, and its value.
struct KeySource {
  Place key, value;
};

/// Places and problems of a study that is being read. Problems are collected, so that one run
/// reports all.
class Reading {
 public:
  /// Syntax of values in messages: JSON for a part of a study in an artefact.
  enum class Syntax { toml, json };

  explicit Reading(std::string origin, Syntax syntax = Syntax::toml)
      : places_(std::move(origin)), syntax_(syntax) {}
  /// A study that has been read before.
  explicit Reading(Places places) : places_(std::move(places)) {}

  bool is_of_json() const { return syntax_ == Syntax::json; }

  /// Notes down where the text of `path` stands, known or not.
  void add_source(const std::string& path, KeySource source) { sources_[path] = std::move(source); }
  /// The origin as a whole where nobody has noted it down.
  KeySource source(const std::string& path) const;

  /// Notes down that the known key `path` is there.
  void found(const std::string& path) { places_.add(path, source(path).value); }
  bool has(const std::string& path) const { return places_.has(path); }
  Place place(const std::string& path) const { return places_.of(path); }

  /// Adds the message at the path's place and remembers that the value can't be relied on.
  void fail(const std::string& path, const std::string& message) {
    fail(path, place(path), message);
  }
  void fail(const std::string& path, const Place& place, const std::string& message);
  /// The same: `path = found, must be words`.
  void reject(const std::string& path, const std::string& found, const std::string& words,
              const std::vector<std::string>& names = {}) {
    fail(path, must_be(display(path), found, words, names));
  }
  /// True when nothing was found wrong with `path`, its members or a table that it is in.
  bool good(const std::string& path) const;

  const std::string& origin() const { return places_.origin(); }
  const Places& places() const { return places_; }

  bool is_fine() const { return problems_.empty(); }
  /// Throws one InputError with a line per problem in the file's order, each line once, and the
  /// number of those beyond the first 50.
  void throw_if_bad() const;

 private:
  struct Problem {
    Place place;
    std::string message;
  };

  Places places_;
  std::vector<Problem> problems_;
  std::set<std::string> failed_;
  std::map<std::string, KeySource> sources_;
  Syntax syntax_ = Syntax::toml;
};

}  // namespace npdr::pipeline
