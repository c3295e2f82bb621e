/// Probes of the rows of a dataset; judges of a method's posteriors, one for each check of
/// pipeline/config/check.h, and their helpers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/text.h"
#include "inference/prior.h"
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
  /// Whether a check is about the posterior that is the result. The network of round 1 isn't that
  /// where there are several: what is found of it is a note.
  bool is_of_result(Check check) const {
    return traits_of(check).input != CheckInput::calibration || method.algorithm.num_rounds == 1;
  }
  /// Each seed and method has an observation of its own.
  bool has_outer_loop() const { return study.num_iterations_of(method) > 1; }
  /// The parameters of the prior that it infers, others it takes as known.
  std::vector<Index> inferred() const;
  /// Fewer than inference::kFewestForBounds.
  bool has_too_few_samples() const;
};

/// " in 2 of 5 seeds"; nothing where there is one.
std::string seeds_text(Index failed, std::size_t all);

/// What a check says of a method: its verdict, then remarks. Their `id` may name a part of the
/// check. Each check has a specialization in a file of this folder, without which nothing links.
template <Check check>
Findings judge(const MethodResults& m);

/// The same of any check. `id`: "fit", or "fit.floor" of a part; `where`: the check's title.
Findings judge(Check check, const MethodResults& m);

/// Verdicts and remarks, of `what`, `evidence` and `advice`. What passes and has something to say
/// is a note.
Finding passes(Finding said);
Finding fails(Finding said);
Finding cannot_tell(Finding said);
/// For less than inference::kFewestForBounds samples.
Finding too_few_samples(Index count);

/// Reasons not to trust the draws of a refined posterior: its certificate's, and that another seed
/// has found more.
std::vector<std::string> faults_of(const MethodResults& m, const EvaluatedRun& run);

/// A check with a p-value, which follows the evidence that its functions give.
struct PValueProbe {
  Check check;
  /// What a diagnosis with a small one found.
  Finding (*said)(const Study& study, const Diagnosis& found, std::uint64_t seed);
  /// Why it could hardly have failed at that level; without `what`: it could have.
  Finding (*too_little)(const Diagnosis& found, double level) = [](const Diagnosis&, double) {
    return Finding();
  };
};
Finding judge_p_value(const MethodResults& m, const PValueProbe& probe);

/// Whether simulations begin in recorded states of a device that moves.
bool begins_in_motion(const MethodResults& m);

/// Whether the noise of such states is inferred by the method; predictions begin in them all the
/// same.
bool infers_first_states(const MethodResults& m);

/// One thing that would let a method learn more of its observation.
std::string advice_to_learn(const MethodResults& m);
/// The same of a refinement of it: one that the study has, or that it may have.
std::string advice_to_refine(const MethodResults& m);
/// One thing to do about a simulator that is probably wrong.
std::string advice_on_model(const Study& study);
/// The same of an observation that is far from what is simulated: the noise of its sensors, where
/// the study says nothing of it; else `otherwise`.
std::string advice_on_noise(const Study& study, std::string otherwise);

/// "1.9", "120".
std::string short_number(double value);

/// The fault of a recording that would explain what the best parameters leave of it; none: they
/// leave its noise, or no such fault does.
std::optional<Finding> words_of_cause(const ReportData& data);
/// What the best parameters leave of a recording that they don't explain, and where its errors are
/// far larger than elsewhere. Needs Baseline::misfit.
Finding words_of_misfit(const ReportData& data);

/// The two of several quantities that are correlated most.
struct CorrelatedPair {
  Index first = 0, second = 0;
  double correlation = 0.0;  ///< 0 where there is no pair
};

/// Of a matrix of correlations (D, D), or of what grows with their size.
CorrelatedPair most_correlated(const RowMatrix& correlations);

/// Looks at theta (n >= 1, D), all of it in the prior, for signs of another distribution. A
/// grave one makes posteriors those of another prior. Of each parameter:
/// - It is the same in all rows: grave.
/// - Its least or largest value lies within 1e-6 of an end of F, where the density of a bounded
///   prior is cut, as that of a grid or of rounded draws does, or is more frequent than others, as
///   that of clipped draws is: told from a fiftieth of the rows on, grave above 0.075.
/// - It is distributed in another way than the prior, by inference::p_value_of_levels(). Grave
///   where inference::distance_of_levels() is above 0.05.
/// - 0.15 of the rows or more have one value, which is twice as many as others have, or it has less
///   than five.
/// And the pair whose F are correlated most surely: grave above 0.2.
///
/// Draws of the prior are accused by each of the two tests with a probability of 1e-4 at most. Rows
/// of the same theta, which are about as often there each, are one draw, and so are those that
/// share a parameter unless its values are inference::are_chosen(). A design, of 20 different
/// values at most, wasn't drawn: of it every row counts.
Findings find_in_theta(const RowMatrix& theta, const inference::Prior& prior);

/// Looks at the rows that `methods` train on with `seed`.
/// - At theta of 10,000 of them at most, by find_in_theta().
/// - At 20,000 in the file's order, as find_apart() does of any rows (sources/first_rows.h).
/// - At the same for rows that are there twice, or nearly: they count several times, and judge as
///   validation what they have taught. Grave where they are a twentieth, and ten times as many as
///   are expected of rows that were drawn by themselves, given how many values each parameter has.
///   None where x of the same theta is mostly another, so that some of it, such as counts, may
///   agree by chance.
/// Nothing of a source that simulates. Throws InputError for a damaged dataset.
Findings find_in_dataset(const Plan& plan, const std::vector<std::string>& methods,
                         std::uint64_t seed);

}  // namespace npdr::pipeline
