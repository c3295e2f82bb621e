#include <fmt/format.h>

#include <map>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/artefacts/asked_rows_file.h"
#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/simulation_file.h"

namespace npdr::pipeline {
namespace {

using List = void (*)(Layout);

// By the names of schemas and parts.
std::map<std::string, List> all_layouts() {
  std::map<std::string, List> all = {{"flow", list_flow},
                                     {"mixture", list_mixture},
                                     {"ratio_network", list_ratio_network},
                                     {"observation", list_observation},
                                     {"particles", list_particles},
                                     {"certificate", list_certificate},
                                     {"posterior", list_posterior},
                                     {"simulation", list_simulation},
                                     {"target", list_target}};
  std::apply([&](const auto&... kinds) { (all.emplace(kinds.name, kinds.list), ...); }, kArtefacts);
  return all;
}

}  // namespace

std::vector<std::string> layout_names() {
  std::vector<std::string> names;
  for (const auto& [name, list] : all_layouts()) names.push_back(name);
  return names;
}

std::string layout_table(const std::string& name) {
  const std::map<std::string, List> layouts = all_layouts();
  const auto list = layouts.find(name);
  if (list == layouts.end()) throw InputError(unknown_name("layout", name, layout_names()));
  const Layout layout = Layout::lister();
  list->second(layout);
  std::string table = "| name | type | shape | meaning |\n|---|---|---|---|\n";
  for (const LayoutRow& row : layout.rows()) {
    table += fmt::format("| `{}` | {} | {} | {} |\n", row.path, row.type, row.shape, row.meaning);
  }
  return table;
}

}  // namespace npdr::pipeline
