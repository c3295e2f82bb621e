/// Keys of a study file, for people: `npdr list keys`, the tables of docs/study-files.md and the
/// commented study that `npdr new NAME` writes.
#pragma once

#include <string>
#include <vector>

#include "pipeline/config/study_json.h"

namespace npdr::pipeline {

/// A study at its defaults, with an element in each list, whose members its fields_of() show.
Study study_with_lists();

/// A field's value as TOML; "required" when it isn't allowed, "" when it may be absent.
std::string default_text(const Field& field);

/// Every key in the order of a study file, with its path as people write it:
/// "method.training.learning_rate".
Fields study_keys();

/// Paths of all tables, and lists of tables, in the same order.
std::vector<std::string> study_tables();

/// The keys that stand in one table, such as "method.training", and in no table inside of it, as a
/// table of Markdown. Throws InputError when the study file has no such table.
std::string keys_markdown(const std::string& table);

/// Names of the tables inside of a [[method]]: "embedding", "density_estimator", ...
std::vector<std::string> method_tables();

/// A study of the pendulum that is called `name`, runs at once and explains every key. Keys at
/// their default are commented out. Throws InputError when `name` can't name a folder.
std::string study_template(const std::string& name);

}  // namespace npdr::pipeline
