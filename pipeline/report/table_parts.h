/// Pieces that the tables of a report share.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "analysis/summary.h"
#include "pipeline/findings/data.h"
#include "pipeline/report/table_of.h"

namespace npdr::pipeline {

/// The label of the row of a method and seed, "NPDR (MAF), 1".
std::string experiment_label(const std::string& method, std::uint64_t seed);

/// A row for each parameter of the prior, which is given by its position.
TableOf<Index> table_of_parameters(const ReportData& data, std::string caption);

/// Title of one of measured_names(): "RMSE, held out".
std::string title_of(const ReportData& data, const std::string& metric);

/// Mean and standard deviation; a footnote says how many samples failed.
Cell cell_of(const analysis::Summary& summary);
/// The cell with that footnote, where any failed.
Cell with_failed(Cell cell, const analysis::Summary& summary);

/// Mean and standard deviation over seeds; a footnote says of how many, where all rollouts of
/// others failed.
Cell cell_of_seeds(const analysis::Summary& summary);

/// Why bands without noise hold less of a recording, which has some; empty where that isn't so.
std::string noiseless_bands_text(const Study& study);

/// Parameters that are known, and where evaluations hold their density.
struct KnownPoint {
  std::string name;
  std::map<std::string, double> parameters;  ///< that aren't nominal
  std::function<double(const Evaluation&)> log_prob;
};
/// The nominal parameters, the truth and the references, as far as the study has them.
std::vector<KnownPoint> known_points(const ReportData& data);

/// Footnotes for a table of densities: references that set parameters beyond the prior's; methods
/// that take parameters as known, whose densities can't be compared with those of all parameters.
std::vector<std::string> density_notes(const ReportData& data);

/// "[0.9, 1.1]", and of samples (n) their 5 % and 95 % quantiles.
std::string interval_text(double low, double high);
std::string interval_text(const Vector& samples);

/// A method's samples (n) of parameter d, of all seeds.
Vector samples_of(const ReportData& data, const std::string& method, Index d);
/// The same of a periodic parameter moved by periods to where they lie around their mean.
Vector unwrapped_samples_of(const ReportData& data, const std::string& method, Index d);
/// The same of feature f, as it was predicted.
Vector predicted_feature(const ReportData& data, const std::string& method, Index f);

/// The samples of all runs, one run after the other.
template <class Runs, class Samples>
Vector pooled(const Runs& runs, const Samples& samples_of) {
  Vector all;
  for (const auto& run : runs) {
    const Vector samples = samples_of(run);
    all.conservativeResize(all.size() + samples.size());
    all.tail(samples.size()) = samples;
  }
  return all;
}

/// Mean and spread of the runs' means.
template <class Runs, class Samples>
analysis::Summary summary_of_means(const Runs& runs, const Samples& samples_of) {
  return analysis::summarize(
      each(runs, [&](const auto& run) { return analysis::summarize(samples_of(run)).mean; }));
}

/// A metric's samples of a run, (n).
inline auto metric_samples(const std::string& metric) {
  return [metric](const EvaluatedRun* run) { return run->evaluation.metrics.at(metric); };
}

}  // namespace npdr::pipeline
