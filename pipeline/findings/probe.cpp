// Helpers and table of the judges. Compiled alone: specializations must not follow their use.
#include "pipeline/findings/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "analysis/begins_at_rest.h"
#include "core/text.h"
#include "inference/diagnostics/bound_pressure.h"

namespace npdr::pipeline {
namespace {

constexpr auto kChecks = enum_table(Check{});

using Judge = Findings (*)(const MethodResults& m);

template <std::size_t... i>
constexpr std::array<Judge, kChecks.size()> judges(std::index_sequence<i...>) {
  return {&judge<kChecks[i].value>...};
}

}  // namespace

Findings judge(Check check, const MethodResults& m) {
  constexpr auto all = judges(std::make_index_sequence<kChecks.size()>());
  const auto row = std::ranges::find(kChecks, check, &CheckTraits::value);
  Findings found = all[static_cast<std::size_t>(row - kChecks.begin())](m);
  for (Finding& finding : found) {
    finding.id = std::string(row->name) + (finding.id.empty() ? "" : "." + finding.id);
    finding.where = row->title;
  }
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

Finding passes(Finding said) {
  said.severity = said.what.empty() ? Severity::fine : Severity::note;
  return said;
}

Finding fails(Finding said) {
  said.severity = Severity::wrong;
  return said;
}

Finding cannot_tell(Finding said) {
  said.severity = Severity::unknown;
  return said;
}

Finding too_few_samples(Index count) {
  return cannot_tell(
      {.what = fmt::format("{} samples are too few to judge", count),
       .evidence = fmt::format("{} of {} samples needed", count, inference::kFewestForBounds),
       .advice =
           fmt::format("Raise num_samples to {} in [evaluate]", inference::kFewestForBounds)});
}

Finding judge_p_value(const MethodResults& m, const PValueProbe& probe) {
  const double level = m.level();
  Index failed = 0;
  double smallest = 1.0;
  Finding said, too_little;
  for (const auto* run : m.diagnoses) {
    const auto p_values = run->result.p_values();
    const auto p = p_values.find(name_of(probe.check));
    if (p != p_values.end()) smallest = std::min(smallest, p->second);
    if (p != p_values.end() && p->second < level) {
      if (failed++ == 0) said = probe.said(m.study, run->result, run->use.seed);
    } else if (too_little.what.empty()) {
      too_little = probe.too_little(run->result, level);
    }
  }
  const bool is_of_result = m.is_of_result(probe.check);
  if (failed == 0 && is_of_result && !too_little.what.empty()) return cannot_tell(too_little);
  const char* sign = m.diagnoses.size() > 1 && smallest < 1.0 ? "≥" : "=";
  said.evidence +=
      fmt::format("{}p {} {:.2g} (fine from {:.2g} on){}", said.evidence.empty() ? "" : ", ", sign,
                  smallest, level, failed > 0 ? seeds_text(failed, m.diagnoses.size()) : "");
  if (is_of_result) return failed > 0 ? fails(said) : passes(said);
  if (failed > 0) said.what = "in round 1, which isn't the result, " + said.what;
  said.advice = "";
  return passes(said);
}

bool begins_in_motion(const MethodResults& m) {
  return m.study.target.recording &&
         (m.study.simulator.segment_length > 0 ||
          !std::ranges::all_of(m.data.target.rollouts, analysis::begins_at_rest));
}

bool infers_first_states(const MethodResults& m) {
  const bool is_fit = family_of(m.method) == inference::AlgorithmFamily::fit;
  return is_fit ? begins_in_motion(m) : m.method.refine.infer_first_states;
}

std::string advice_to_learn(const MethodResults& m) {
  if (m.is(inference::Algorithm::refine)) return "Raise max_simulations in [method.refine]";
  if (family_of(m.method) == inference::AlgorithmFamily::fit) {
    return "Raise max_simulations in [method.least_squares]";
  }
  using enum inference::EmbeddingKind;
  const inference::EmbeddingKind kind = m.method.embedding.kind;
  const bool sees_all = m.method.embedding.trains_layers() || kind == all_steps || kind == identity;
  return sees_all ? "Raise num_simulations in [[method]]"
                  : "Set principal_components = 20 in place of kind in [method.embedding]";
}

std::string advice_to_refine(const MethodResults& m) {
  const auto refines = [&](const MethodConfig& other) {
    return other.algorithm.kind == inference::Algorithm::refine &&
           other.refine.start == m.method.name;
  };
  const auto found = std::ranges::find_if(m.study.methods, refines);
  if (found != m.study.methods.end()) {
    return fmt::format("Use {}, which refines {}", found->name, m.method.name);
  }
  if (m.has_outer_loop()) return advice_to_learn(m);
  return fmt::format("Add a [[method]] with algorithm = \"refine\" and refine.start = \"{}\"",
                     m.method.name);
}

std::string advice_on_model(const Study& study) {
  return study.source().gives_motion
             ? "Look for an effect that the simulator lacks, such as friction or a delay"
             : "Look for an effect that the simulator lacks";
}

std::string advice_on_noise(const Study& study, std::string otherwise) {
  const bool is_unstated = study.target.recording && study.observation_noise.is_silent() &&
                           !study.places.has("observation_noise.scale");
  return is_unstated ? "State the noise of the sensors by scale in [observation_noise]"
                     : std::move(otherwise);
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
