/// Keys of a study file, for people: `npdr list keys` and the tables of docs/study-files.md.
#pragma once

#include <string>
#include <vector>

#include "pipeline/config/field_list.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// One table of a study file, or one list of tables.
struct StudyTable {
  std::string path;  ///< such as "method.training"
  std::string doc;   ///< one line
};

/// One key of a study file.
struct StudyKey {
  std::string path;           ///< such as "method.training.learning_rate"
  std::string type;           ///< such as "a finite number"
  std::string default_value;  ///< as TOML; "required" when there is none, "" when it may be absent
  std::string allowed;        ///< such as "> 0"; empty: everything of the type
  std::vector<std::string> names;  ///< the choices, where there are only a few
  std::string doc;                 ///< one line

  /// The path's last part: "learning_rate".
  std::string name() const { return path.substr(path.rfind('.') + 1); }
};

/// A study at its defaults, with an element in each list, whose members its fields_of() show.
Study study_with_lists();

/// As StudyKey::default_value.
std::string default_text(const Field& field);

/// Every table, in the order of a study file.
std::vector<StudyTable> study_tables();

/// Every key, in the same order.
std::vector<StudyKey> study_keys();

/// Those that stand in one table, such as "method.training", and in no table inside of it, as a
/// table of Markdown. Throws InputError when the study file has no such table.
std::string keys_markdown(const std::string& table);

/// Names of the tables inside of a [[method]]: "embedding", "density_estimator", ...
std::vector<std::string> method_tables();

}  // namespace npdr::pipeline
