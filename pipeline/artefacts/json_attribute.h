/// Settings as attributes of files: JSON, as in the resolved study.
#pragma once

#include <string>

#include "pipeline/artefacts/layout.h"
#include "pipeline/config/study_json.h"
#include "pipeline/store/hostile_json.h"

namespace npdr::pipeline {

template <class Config>
void describe_json(Layout f, const std::string& name, Config& config, const char* meaning) {
  std::string text = to_json(config).dump();
  f.attribute(name, text, meaning);
  if (f.reads()) {
    const std::string where = f.where() + ": attribute '" + name + "'";
    config = from_json<Config>(parse_json(text, where), where);
  }
}

}  // namespace npdr::pipeline
