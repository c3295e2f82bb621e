// A method without fault, whose data tests change.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "core/normal.h"
#include "pipeline/config/check.h"
#include "pipeline/findings/findings.h"
#include "tests/pipeline/small_study.h"

namespace npdr::pipeline {

inline const std::string kMethod = "NPDR (MAF)";

// Samples at even quantiles of N(mean, std^2), cut off at the box of the small study's prior.
inline RowMatrix samples_around(double mean, double std) {
  constexpr Index n = 400;
  RowMatrix theta(n, 2);
  for (Index d = 0; d < 2; ++d) {
    const double low = normal_cdf((0.3 - mean) / std), high = normal_cdf((1.7 - mean) / std);
    for (Index i = 0; i < n; ++i) {
      // The second column in another order: they don't depend on each other.
      const Index rank = d == 0 ? i : (i * 171) % n;
      const double p = low + (high - low) * (static_cast<double>(rank) + 0.5) / n;
      theta(i, d) = mean + std * normal_quantile(p);
    }
  }
  return theta;
}

class Verdicts : public ::testing::Test {
 protected:
  Verdicts()
      : plan_(make_plan(parse_study(kStudyText, "s.toml", {}), WorkFolder("runs"))),
        data_{plan_, sim::make_simulator(plan_.study.simulator)->info(), {kMethod}, {1}, {}, {}} {
    plan_.study.methods.front().algorithm.num_simulations = 1'000'000;  // enough anywhere
    data_.target.state_channels = data_.info.state_channels;
    data_.target.rollouts = {{"one", RowMatrix::Ones(201, 2), RowMatrix::Zero(200, 1)}};
    data_.baseline.prior = PriorPredictions{{{"rmse", Vector::Constant(100, 1.0)}}, {}};
    add_run(samples_around(1.0, 0.02), 0.02);
    data_.diagnoses.push_back({{kMethod, 1, 0}, {}});
    Diagnosis& diagnosis = data_.diagnoses.back().result;
    diagnosis.predictive.emplace();
    diagnosis.predictive->check.overall.num_reference = 100;
    diagnosis.predictive->median = Vector::Zero(1);
    diagnosis.width = {Vector::Constant(2, 1.0), true};
    diagnosis.ood.emplace().num_reference = 100;
    diagnosis.failures.emplace();
    diagnosis.training.emplace().is_converged = true;
  }

  void add_run(const RowMatrix& theta, double rmse) {
    EvaluatedRun run;
    run.use = {kMethod, 1, 1};
    run.last_round = true;
    run.evaluation.theta = theta;
    run.evaluation.metrics["rmse"] = Vector::Constant(theta.rows(), rmse);
    data_.runs = {run};
  }

  Finding finding_of(Check check) const {
    const std::vector<Finding> all = findings_of(data_, kMethod);
    return *std::ranges::find(all, check, &check_of);
  }

  // "fit.room" of a remark.
  std::optional<Finding> remark_of(const std::string& id) const {
    const std::vector<Finding> all = findings_of(data_, kMethod);
    const auto found = std::ranges::find(all, id, &Finding::id);
    return found == all.end() ? std::nullopt : std::optional(*found);
  }

  Plan plan_;
  ReportData data_;
};

}  // namespace npdr::pipeline
