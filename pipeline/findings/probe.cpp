// Helpers and table of the judges. Compiled alone: specializations must not follow their use.
#include "pipeline/findings/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"

namespace npdr::pipeline {
namespace {

constexpr auto kChecks = enum_table(Check{});

using Judge = Finding (*)(const MethodResults& m);

template <std::size_t... i>
constexpr std::array<Judge, kChecks.size()> judges(std::index_sequence<i...>) {
  return {&judge<kChecks[i].value>...};
}

}  // namespace

Finding judge(Check check, const MethodResults& m) {
  constexpr auto all = judges(std::make_index_sequence<kChecks.size()>());
  const auto row = std::ranges::find(kChecks, check, &CheckTraits::value);
  Finding found = all[static_cast<std::size_t>(row - kChecks.begin())](m);
  found.id = row->name;
  found.where = row->title;
  return found;
}

MethodResults::MethodResults(const ReportData& all, const std::string& name)
    : data(all),
      study(all.plan.study),
      method(study.method(name)),
      checks(study.diagnose_of(method)),
      runs(all.runs_of(name)),
      diagnoses(all.diagnoses_of(name)) {}

double MethodResults::level() const {
  const auto can_fail = [this](Check check) {
    return traits_of(check).has_p_value && is_of_result(check);
  };
  const auto tests = static_cast<std::size_t>(std::ranges::count_if(checks.checks, can_fail));
  return checks.alpha / static_cast<double>(std::max<std::size_t>(tests * diagnoses.size(), 1));
}

std::vector<Index> MethodResults::inferred() const {
  std::vector<Index> found;
  for (Index d = 0; d < std::ssize(study.prior); ++d) {
    if (data.is_inferred(method.name, d)) found.push_back(d);
  }
  return found;
}

bool MethodResults::has_too_few_samples() const {
  return runs.front()->evaluation.theta.rows() < inference::kFewestForBounds;
}

std::string seeds_text(Index failed, std::size_t all) {
  return all == 1 ? "" : fmt::format(" in {} of {} seeds", failed, all);
}

Finding passes(const std::string& evidence, std::string what) {
  const Severity severity = what.empty() ? Severity::fine : Severity::note;
  return {.severity = severity,
          .what = std::move(what),
          .evidence = evidence.empty() ? "passes" : "passes, " + evidence};
}

Finding fails(std::string evidence, std::string what) {
  return {.severity = Severity::wrong, .what = std::move(what), .evidence = std::move(evidence)};
}

Finding cannot_tell(std::string what, std::string evidence) {
  return {.severity = Severity::unknown, .what = std::move(what), .evidence = std::move(evidence)};
}

Finding notes_down(std::string evidence, std::string what) {
  return {.severity = what.empty() ? Severity::fine : Severity::note,
          .what = std::move(what),
          .evidence = std::move(evidence)};
}

Finding too_few_samples(Index count) {
  return cannot_tell(fmt::format("{} samples are too few; raise evaluate.num_samples to {} or more",
                                 count, inference::kFewestForBounds));
}

Finding judge_p_value(const MethodResults& m, const PValueProbe& probe) {
  const double level = m.level();
  Index failed = 0;
  double smallest = 1.0;
  std::string what, too_little;
  for (const auto* run : m.diagnoses) {
    const auto p_values = run->result.p_values();
    const auto p = p_values.find(name_of(probe.check));
    if (p != p_values.end()) smallest = std::min(smallest, p->second);
    if (p != p_values.end() && p->second < level) {
      ++failed;
      if (what.empty()) what = probe.what(m.study, run->result, run->use.seed);
    } else if (too_little.empty()) {
      too_little = probe.too_little(run->result, level);
    }
  }
  const char* sign = m.diagnoses.size() > 1 && smallest < 1.0 ? "≥" : "=";
  const std::string p_text = fmt::format("p {} {:.2g}", sign, smallest);
  if (!m.is_of_result(probe.check)) {
    return notes_down("of round 1, " + p_text,
                      failed == 0 ? ""
                                  : "no fault of the result, which a later round has made: in "
                                    "round 1 " +
                                        what);
  }
  if (failed > 0)
    return fails(probe.failure + seeds_text(failed, m.diagnoses.size()) + ", " + p_text, what);
  return too_little.empty() ? passes(p_text) : cannot_tell(too_little);
}

std::string advice_to_learn(const MethodConfig& method) {
  using enum inference::EmbeddingKind;
  const inference::EmbeddingKind kind = method.embedding.kind;
  const bool sees_all = method.embedding.trains_layers() || kind == all_steps || kind == identity;
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
  if (study.source().gives_motion && !noise.is_correlated()) keys.emplace_back("correlation");
  if (!noise.is_heavy_tailed()) keys.emplace_back("degrees_of_freedom");
  return keys.empty() ? "" : " (observation_noise." + join(keys) + ")";
}

CorrelatedPair most_correlated(const RowMatrix& correlations) {
  CorrelatedPair most;
  for (Index d = 0; d < correlations.rows(); ++d) {
    for (Index e = d + 1; e < correlations.cols(); ++e) {
      const double r = correlations(d, e);
      if (std::abs(r) > std::abs(most.correlation)) most = {d, e, r};
    }
  }
  return most;
}

}  // namespace npdr::pipeline
