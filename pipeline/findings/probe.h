/// What the judges of a method's posteriors share: one for each check of pipeline/config/check.h.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "pipeline/config/check.h"
#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// Those of one method, in the order of seeds.
using Runs = std::vector<const EvaluatedRun*>;

/// One method, and what its stages have made.
struct MethodResults {
  MethodResults(const ReportData& all, const std::string& method);

  const ReportData& data;
  const Study& study;
  const MethodConfig& method;
  DiagnoseConfig checks;  ///< that mean something to it
  Runs runs;              ///< of the last round
  std::vector<const ResultOf<Diagnosis>*> diagnoses;

  /// The p-value below which one of its checks fails: Bonferroni over those, and the seeds.
  double level() const;
  bool is(inference::Algorithm kind) const { return method.algorithm.kind == kind; }
  /// The parameters of the prior that it infers, others it takes as known.
  std::vector<Index> inferred() const;
  /// Fewer than inference::kFewestForBounds.
  bool has_too_few_samples() const;
};

/// " in 2 of 5 seeds"; nothing where there is one.
std::string seeds_text(Index failed, std::size_t all);

/// What a check says of a method; its `id` is the check's name already. Each check has a
/// specialization in a file of this folder, without which nothing links.
template <Check check>
Finding judge(const MethodResults& m);

/// The same of any check.
Finding judge(Check check, const MethodResults& m);

Finding passes(const std::string& evidence, std::string what = "");
Finding fails(std::string evidence, std::string what);
Finding cannot_tell(std::string what, std::string evidence = "can't tell");
/// For less than inference::kFewestForBounds samples.
Finding too_few_samples(Index count);

/// A check with a p-value.
struct PValueProbe {
  Check check;
  /// What a diagnosis with a small one found, and what to do.
  std::string (*what)(const Study& study, const Diagnosis& found, std::uint64_t seed);
  /// Why it could hardly have failed at that level; "": it could have.
  std::string (*too_little)(const Diagnosis& found, double level) = [](const Diagnosis&, double) {
    return std::string();
  };
  const char* failure = "FAILS";
};
Finding judge_p_value(const MethodResults& m, const PValueProbe& probe);

/// What would let a method learn more of its observation.
std::string advice_to_learn(const MethodConfig& method);

/// Whether the observation is a recording, and the study doesn't say what noise it has, nor that it
/// has none.
bool is_noise_unstated(const Study& study);

/// What [observation_noise] may say that it doesn't yet, in brackets, for "simulator or noise lack
/// something"; "": nothing, or the observation is simulated without noise.
std::string noise_hint(const Study& study);

/// The two of several quantities that are correlated most.
struct CorrelatedPair {
  Index first = 0, second = 0;
  double correlation = 0.0;  ///< 0 where there is no pair
};

/// Of a matrix of correlations (D, D), or of what grows with their size.
CorrelatedPair most_correlated(const RowMatrix& correlations);

}  // namespace npdr::pipeline
