#include "pipeline/report/verdict_parts.h"

#include <fmt/format.h>

#include "core/text.h"
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

bool is_noise_unstated(const Study& study) {
  return study.target.recording && study.observation_noise.is_silent() &&
         !study.places.has("observation_noise.scale");
}

std::string noise_hint(const Study& study) {
  const ObservationNoise& noise = study.observation_noise;
  if (noise.is_silent()) {
    return is_noise_unstated(study) ? " (the study states no noise of the recording's sensors: "
                                      "observation_noise.scale, or scale_prior to infer it)"
                                    : "";
  }
  std::vector<std::string> keys;
  if (!noise.scale_prior) keys.emplace_back("scale_prior");
  if (study.source().gives_motion && !noise.correlation && !noise.correlation_prior) {
    keys.emplace_back("correlation");
  }
  if (!noise.degrees_of_freedom && !noise.degrees_of_freedom_prior) {
    keys.emplace_back("degrees_of_freedom");
  }
  return keys.empty() ? "" : " (observation_noise." + join(keys) + ")";
}

}  // namespace npdr::pipeline
