/// What is wrong with a study and where: collected, so that one run reports everything.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// Where a value stands: a file's line and column (counted from 1), or a command-line override.
struct Place {
  std::string origin;  ///< file name, or "--set key=value"
  int line = 0;        ///< 0: the origin as a whole
  int column = 0;

  /// "study.toml:14:9".
  std::string str() const;
};

/// Problems of one study.
class Problems {
 public:
  void add(const Place& place, const std::string& message);
  bool empty() const { return problems_.empty(); }

  /// Throws one InputError with a line per problem in the file's order, each line once.
  void throw_if_any() const;

 private:
  struct Problem {
    Place place;
    std::string message;
  };
  std::vector<Problem> problems_;
};

/// A reading in progress: what went wrong so far and where each key stands. Keys are dotted paths
/// with the position in a list, such as "method[0].training.batch_size".
class Reading {
 public:
  explicit Reading(std::string origin) : origin_(std::move(origin)) {}

  void found(const std::string& path, const Place& place) { places_[path] = place; }
  bool has(const std::string& path) const { return places_.contains(path); }

  /// Where `path` stands; for a key that was left out, where its table stands.
  Place place(const std::string& path) const;

  /// Adds "path message" at the path's place and remembers that the value can't be relied on.
  void fail(const std::string& path, const std::string& message);
  void fail(const std::string& path, const Place& place, const std::string& message);
  /// True when nothing was found wrong with `path`, its members or a table that it is in.
  bool good(const std::string& path) const;

  const std::string& origin() const { return origin_; }
  const Problems& problems() const { return problems_; }

 private:
  std::string origin_;
  Problems problems_;
  std::map<std::string, Place> places_;
  std::vector<std::string> failed_;
};

/// "method[0].training" as people write it: "method.training".
std::string display(const std::string& path);

}  // namespace npdr::pipeline
