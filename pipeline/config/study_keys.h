/// What a study file may hold, for people: `npdr list keys` prints this.
#pragma once

#include <string>
#include <vector>

namespace npdr::pipeline {

/// One key of a study file.
struct StudyKey {
  std::string path;           ///< such as "method.training.learning_rate"
  std::string type;           ///< such as "a finite number"
  std::string default_value;  ///< as JSON; "required" when there is none, "" when it may be absent
  std::string allowed;        ///< such as "> 0"; empty: everything of the type
  std::string doc;            ///< one line
};

/// Every key, in the order of a study file.
std::vector<StudyKey> study_keys();

/// Names of the tables inside of a [[method]]: "embedding", "density_estimator", ...
std::vector<std::string> method_tables();

}  // namespace npdr::pipeline
