/// Fields of a study (study_fields.h) that hold values of an enumeration.
#pragma once

#include <string>
#include <vector>

#include "core/enum_names.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/field_use.h"

namespace npdr::pipeline {

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
