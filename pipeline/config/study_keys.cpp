#include "pipeline/config/study_keys.h"

#include "pipeline/config/json_fields.h"
#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {
namespace {

template <class T, class C>
std::string default_text(const T& value, const Constraint<C>& allowed) {
  return satisfies(value, allowed) ? json_value(value).dump() : "required";
}

template <class T, class C>
std::string default_text(const std::optional<T>& /*value*/, const Constraint<C>& /*allowed*/) {
  return "";
}

// The visitor that writes down what the others read and write.
class KeyLister {
 public:
  KeyLister(std::string prefix, std::vector<StudyKey>& keys)
      : prefix_(std::move(prefix)), keys_(keys) {}

  template <class T, class C>
  void operator()(const std::string& key, const T& value, const Constraint<C>& allowed,
                  std::string_view doc) {
    keys_.push_back({prefix_ + key, type_name<T>(), default_text(value, allowed), allowed.words,
                     std::string(doc)});
  }

  template <class Body>
  void table(const std::string& key, std::string_view /*doc*/, const Body& body) {
    KeyLister members(prefix_ + key + ".", keys_);
    body(members);
  }

  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& /*values*/, int /*minimum*/,
            std::string_view /*doc*/, const Body& body) {
    KeyLister members(prefix_ + key + ".", keys_);
    T element;
    body(members, element);
  }

 private:
  std::string prefix_;
  std::vector<StudyKey>& keys_;
};

// The visitor that writes down the names of the tables it meets.
struct TableLister {
  template <class T, class C>
  void operator()(const std::string&, const T&, const Constraint<C>&, std::string_view) {}

  template <class Body>
  void table(const std::string& key, std::string_view, const Body&) {
    names.push_back(key);
  }

  std::vector<std::string> names;
};

}  // namespace

std::vector<StudyKey> study_keys() {
  std::vector<StudyKey> keys;
  Study defaults;
  KeyLister lister("", keys);
  describe(lister, defaults);
  return keys;
}

std::vector<std::string> method_tables() {
  TableLister lister;
  MethodConfig method;
  describe(lister, method);
  lister.names.emplace_back("published");
  return lister.names;
}

}  // namespace npdr::pipeline
