#include "pipeline/config/study.h"

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {

const MethodConfig& Study::method(const std::string& method_name) const {
  std::vector<std::string> names;
  for (const MethodConfig& m : methods) {
    if (m.name == method_name) return m;
    names.push_back(m.name);
  }
  throw InputError(unknown_name("method", method_name, names));
}

std::vector<std::string> metric_names() { return {"dtw", "rmse"}; }

}  // namespace npdr::pipeline
