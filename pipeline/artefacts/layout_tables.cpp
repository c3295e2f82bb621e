#include "pipeline/artefacts/layout_tables.h"

#include <fmt/format.h>

#include <map>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

const std::map<std::string, void (*)(Layout)> kLayouts = {
    {"asked_rows", list_asked_rows},
    {"baseline", list_baseline},
    {"diagnosis", list_diagnosis},
    {"diagnosis_checkpoint", list_diagnosis_checkpoint},
    {"evaluation", list_evaluation},
    {"flow", list_flow},
    {"mixture", list_mixture},
    {"ratio_network", list_ratio_network},
    {"observation", list_observation},
    {"particles", list_particles},
    {"certificate", list_certificate},
    {"policy", list_policy},
    {"policy_checkpoint", list_policy_checkpoint},
    {"policy_test", list_policy_test},
    {"posterior", list_posterior},
    {"proposal", list_proposal},
    {"simulation", list_simulation},
    {"target", list_target},
    {"training_checkpoint", list_training_checkpoint},
    {"refinement_checkpoint", list_refinement_checkpoint},
    {"simulated_rows", list_simulated_rows}};

}  // namespace

std::vector<std::string> layout_names() {
  std::vector<std::string> names;
  for (const auto& [name, list] : kLayouts) names.push_back(name);
  return names;
}

std::string layout_table(const std::string& name) {
  const auto list = kLayouts.find(name);
  if (list == kLayouts.end()) throw InputError(unknown_name("layout", name, layout_names()));
  const Layout layout = Layout::lister();
  list->second(layout);
  std::string table = "| name | type | shape | meaning |\n|---|---|---|---|\n";
  for (const LayoutRow& row : layout.rows()) {
    table += fmt::format("| `{}` | {} | {} | {} |\n", row.path, row.type, row.shape, row.meaning);
  }
  return table;
}

}  // namespace npdr::pipeline
