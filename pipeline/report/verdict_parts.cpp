#include "pipeline/report/verdict_parts.h"

#include <fmt/format.h>

#include "inference/diagnostics/bound_pressure.h"

namespace npdr::pipeline {

Verdict too_few_samples(Check check, Index count) {
  return {check, Judgment::unknown, "can't tell",
          fmt::format("{} samples are too few; raise evaluate.num_samples to {} or more", count,
                      inference::kFewestForBounds)};
}

const std::string& name_of_parameter(const ReportData& data, Index d) {
  return data.plan.study.prior[static_cast<std::size_t>(d)].name;
}

std::string advice_to_learn(const ReportData& data, const std::string& method) {
  using enum inference::EmbeddingKind;
  const inference::EmbeddingKind kind = data.plan.study.method(method).embedding.kind;
  const bool sees_all = trains_layers(kind) || kind == all_steps || kind == identity;
  return (sees_all ? "" : "embedding.principal_components without embedding.kind, ") +
         std::string("more simulations");
}

}  // namespace npdr::pipeline
