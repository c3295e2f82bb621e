/// What was found of something that users gave or got: a study, a recording, rows, a posterior.
#pragma once

#include <array>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "core/enum_names.h"

namespace npdr {

/// From nothing to be said of it to an answer that is wrong.
enum class Severity {
  fine,
  note,        ///< worth knowing
  suspicious,  ///< probably not what was meant: a warning
  unknown,     ///< too little to tell
  wrong,
};

constexpr auto enum_table(Severity) {
  using enum Severity;
  return std::to_array<EnumRow<Severity>>({{fine, "fine"},
                                           {note, "note"},
                                           {suspicious, "suspicious"},
                                           {unknown, "unknown"},
                                           {wrong, "wrong"}});
}

struct Finding {
  std::string id = {};  ///< of the probe that found it
  Severity severity = Severity::suspicious;
  std::string where = {};     ///< "study.toml:14:9"; empty where `what`, or who prints it, says so
  std::string what = {};      ///< what is the matter, a sentence; empty where that is nothing
  std::string evidence = {};  ///< a number beside its limit: "4.3 times the noise (fine below 2)"
  std::string advice = {};    ///< one thing to do, a sentence
};

using Findings = std::vector<Finding>;

inline Finding warning(std::string what, std::string where = "") {
  return {.where = std::move(where), .what = std::move(what)};
}
inline Finding note(std::string what) {
  return {.severity = Severity::note, .what = std::move(what)};
}

/// What it says: what is the matter, the evidence, the advice, as far as there are any.
std::vector<std::string> lines_of(const Finding& finding);
/// "study.toml:14:9: warning: ..."; without "warning: " where it is none.
std::string text_of(const Finding& finding);
std::vector<std::string> texts_of(const Findings& findings);

/// Adds `more` to `all`.
template <class T>
void append(std::vector<T>& all, std::vector<T> more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// Something to look for in a subject.
template <class Subject>
struct Probe {
  std::string_view id;
  Findings (*look)(const Subject& subject);
  bool (*applies)(const Subject& subject) = [](const Subject&) { return true; };
};

/// What the probes of a table find, in their order.
template <class Subject, std::size_t count>
Findings find_by(const std::array<Probe<Subject>, count>& probes, const Subject& subject) {
  Findings all;
  for (const Probe<Subject>& probe : probes) {
    if (!probe.applies(subject)) continue;
    for (Finding& finding : probe.look(subject)) {
      finding.id = probe.id;
      all.push_back(std::move(finding));
    }
  }
  return all;
}

}  // namespace npdr
