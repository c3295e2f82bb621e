#include "pipeline/report/dataset.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/normal.h"
#include "inference/diagnostics/uniformity.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostRows = 10'000;
constexpr double kFalseAlarmRate = 1e-4;

// Rows that the first seed trains on, in the space in which the prior is N(0, I).
RowMatrix normal_theta(const ReportData& data) {
  const Study& study = data.plan.study;
  const inference::Prior prior(study.prior);
  const Index count =
      std::min(kMostRows, study.method(data.methods.front()).algorithm.num_simulations);
  const RowMatrix all = *data.plan.source->theta(data.seeds.front(), count);
  RowMatrix inside(all.rows(), all.cols());
  Index num_inside = 0;
  for (Index i = 0; i < all.rows(); ++i) {
    if (prior.contains(all.row(i).transpose())) inside.row(num_inside++) = all.row(i);
  }
  return prior.to_normal(inside.topRows(num_inside));
}

}  // namespace

void note_foreign_theta(const ReportData& data, analysis::Table& table) {
  if (data.plan.study.source().simulates) return;
  const RowMatrix u = normal_theta(data);
  if (u.rows() == 0) return;
  for (Index d = 0; d < u.cols(); ++d) {
    const Vector uniform = u.col(d).unaryExpr([](double v) { return normal_cdf(v); });
    const auto test = inference::test_kolmogorov_smirnov(uniform);
    if (inference::corrected(test.p_value, u.cols()) >= kFalseAlarmRate) continue;
    table.footnote(fmt::format(
        "{} of the dataset isn't distributed as the prior says (Kolmogorov-Smirnov {:.2f}, p = "
        "{:.1g}): where its theta wasn't drawn from this prior, posteriors are those of another "
        "one",
        data.plan.study.prior[static_cast<std::size_t>(d)].name, test.statistic, test.p_value));
  }
}

}  // namespace npdr::pipeline
