/// The commented study that `npdr new NAME` writes.
#pragma once

#include <string>

namespace npdr::pipeline {

/// A study of the pendulum that is called `name`, runs at once and explains every key. Keys at
/// their default are commented out. Throws InputError when `name` can't name a folder.
std::string study_template(const std::string& name);

}  // namespace npdr::pipeline
