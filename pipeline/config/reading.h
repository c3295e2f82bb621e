/// What is known of a study while it is read: where its keys stand, and what is wrong with them.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/text.h"
#include "pipeline/config/places.h"

namespace npdr::pipeline {

/// "method[0].training" as people write it: "method.training".
std::string display(const std::string& path);

/// Problems are collected, so that one run reports everything.
class Reading {
 public:
  explicit Reading(std::string origin) : places_(std::move(origin)) {}
  /// A part of a study in an artefact, whose values messages write as JSON.
  static Reading of_json(std::string origin) {
    Reading reading(std::move(origin));
    reading.is_of_json_ = true;
    return reading;
  }
  /// A study that has been read before.
  explicit Reading(Places places) : places_(std::move(places)) {}

  bool is_of_json() const { return is_of_json_; }

  /// Notes down where the text of `path` stands, known or not.
  void add_source(const std::string& path, KeySource source) { sources_[path] = std::move(source); }
  /// The origin as a whole where nobody has noted it down.
  KeySource source(const std::string& path) const;

  void found(const std::string& path, const Place& place) { places_.add(path, place); }
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
  bool is_of_json_ = false;
};

}  // namespace npdr::pipeline
