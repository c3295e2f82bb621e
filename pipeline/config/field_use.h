/// When a field of a study means something, and what changes with it: the part of its description
/// (study_fields.h) that keys and checks follow from. Fields that hold values of an enumeration.
#pragma once

#include <string>
#include <vector>

#include "core/enum_names.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {

/// The artefacts whose keys a field's value is part of. What changes any key but those of nothing
/// changes the report's, too.
enum class Affects {
  results,    ///< all that its table is about: key_json() writes it as it stands
  training,   ///< posteriors of networks alone
  task,       ///< closed loops of a policy, and the search for it
  elsewhere,  ///< those that a plan or a source notes down by hand: what a file holds, which rounds
  report,     ///< the report's alone
  nothing,
};

/// A field that says nothing means something everywhere, and affects all that its table is about.
/// What a table says holds for its members.
struct FieldUse {
  Affects affects = Affects::results;
  std::string unused = {};  ///< end of "... must be left out"; "": it means something
  bool settable = false;    ///< by --set where it is unused: that may be meant for others
  bool omitted = false;     ///< from documents of studies, which are older than the field
};

/// FieldUse::unused: "" where the field means something, else ": why".
inline std::string unless(bool means_something, const std::string& why) {
  return means_something ? "" : ": " + why;
}

/// A field that holds one value of an enumeration: its name to every visitor.
template <class Fields, NamedEnum E>
void choice(Fields& f, const char* key, E& value, const char* doc, const FieldUse& use = {}) {
  std::string name = name_of(value);
  f(key, name, one_of<E>(), doc, use);
  value = parse_enum<E>(key, name);
}

/// A field that holds several of them.
template <class Fields, NamedEnum E>
void choices(Fields& f, const char* key, std::vector<E>& values,
             const Constraint<std::vector<std::string>>& allowed, const char* doc) {
  std::vector<std::string> names = to_names(values);
  f(key, names, allowed, doc);
  values.clear();
  for (const std::string& name : names) values.push_back(parse_enum<E>(key, name));
}

}  // namespace npdr::pipeline
