#include "pipeline/config/field_use.h"

#include <algorithm>

#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {
namespace {

// The visitor that looks for them.
class UnusedFinder {
 public:
  UnusedFinder(std::string prefix, std::vector<UnusedField>& found)
      : prefix_(std::move(prefix)), found_(found) {}

  template <class T, class C>
  void operator()(const std::string& key, const T& /*value*/, const Constraint<C>& /*allowed*/,
                  std::string_view /*doc*/, const FieldUse& use = {}) {
    note(key, use);
  }

  template <class Body>
  void table(const std::string& key, std::string_view /*doc*/, const Body& body,
             const FieldUse& use = {}) {
    if (note(key, use)) return;
    UnusedFinder members(prefix_ + key + ".", found_);
    body(members);
  }

  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int /*minimum*/,
            std::string_view /*doc*/, const Body& body, const FieldUse& use = {}) {
    if (note(key, use)) return;
    for (std::size_t i = 0; i < values.size(); ++i) {
      UnusedFinder members(prefix_ + key + "[" + std::to_string(i) + "].", found_);
      body(members, values[i]);
    }
  }

 private:
  bool note(const std::string& key, const FieldUse& use) {
    if (use.unused.empty()) return false;
    found_.push_back({prefix_ + key, use});
    return true;
  }

  std::string prefix_;
  std::vector<UnusedField>& found_;
};

template <class Config, class... Context>
std::vector<UnusedField> find_unused(Config config, const std::string& path,
                                     const Context&... context) {
  std::vector<UnusedField> found;
  UnusedFinder finder(path.empty() ? "" : path + ".", found);
  describe(finder, config, context...);
  return found;
}

}  // namespace

std::string unless(bool means_something, const std::string& why) {
  return means_something ? "" : ": " + why;
}

template <class Config>
std::vector<UnusedField> unused_fields(const Config& config, const std::string& path) {
  return find_unused(config, path);
}

std::vector<UnusedField> unused_fields(const MethodConfig& method, const PolicyConfig& policy,
                                       const std::string& path) {
  return find_unused(method, path, policy);
}

bool reads_setting(inference::Algorithm algorithm, const std::string& key) {
  MethodConfig method;
  method.algorithm.kind = algorithm;
  PolicyConfig any;
  any.search.kind = inference::PolicyOptimizerKind::power;
  return std::ranges::count(unused_fields(method, any, ""), key, &UnusedField::path) == 0;
}

template std::vector<UnusedField> unused_fields(const SimulatorTable&, const std::string&);
template std::vector<UnusedField> unused_fields(const ObservationNoise&, const std::string&);
template std::vector<UnusedField> unused_fields(const PolicyConfig&, const std::string&);

}  // namespace npdr::pipeline
