#include "pipeline/report/pooling_text.h"

#include <fmt/format.h>

#include <vector>

#include "core/text.h"

namespace npdr::pipeline {

std::string pooling_text(const Study& study) {
  std::vector<std::string> names;
  for (const MethodConfig& method : study.methods) {
    if (method.algorithm.kind == inference::Algorithm::npe_nle) names.push_back(method.name);
  }
  if (names.empty()) return "";
  const std::string seen = study.source().gives_motion ? "motion" : "observation";
  return fmt::format(
      "{0} combine{1} two kinds of neural networks that learn from the same simulations: one says "
      "which parameters explain the {2} (neural posterior estimation, NPE), the other to which {2} "
      "parameters lead (neural likelihood estimation, NLE). Each counts as much as it has proved "
      "to predict simulations that neither had seen: its power in the table of experiments. Where "
      "the powers add up to more than 1, both together are narrower than each, which such "
      "simulations bore out.",
      join(names, names.size() == 2 ? " and " : ", "), names.size() == 1 ? "s" : "", seen);
}

}  // namespace npdr::pipeline
