#include "pipeline/config/toml_fields.h"

#include <algorithm>

namespace npdr::pipeline {

const toml::node* TomlFields::look_up(const std::string& key) {
  known_.push_back(key);
  const toml::node* node = table_ == nullptr ? nullptr : table_->get(key);
  if (node != nullptr) reading_.found(below(key), place_of(node->source(), reading_.origin()));
  return node;
}

void TomlFields::reject_unknown_keys() {
  if (table_ == nullptr) return;
  for (auto&& [key, node] : *table_) {
    const std::string name(key.str());
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const std::string where = path_.empty() ? "" : display(path_) + ": ";
    reading_.fail(below(name), place_of(key.source(), reading_.origin()),
                  where + unknown_name("key", shortened(name), known_));
  }
}

}  // namespace npdr::pipeline
