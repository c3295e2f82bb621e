#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "analysis/figure.h"
#include "analysis/interval_plot.h"
#include "analysis/pair_plot.h"
#include "analysis/report.h"
#include "core/normal.h"
#include "core/quantile.h"
#include "core/text.h"
#include "inference/prior.h"
#include "pipeline/findings/findings.h"
#include "pipeline/report/parts.h"

namespace npdr::pipeline {
namespace {

// A row for each parameter of the prior, which is given by its position.
TableOf<Index> table_of_parameters(const ReportData& data, std::string caption) {
  const std::vector<inference::Marginal>& prior = data.plan.study.prior;
  std::vector<Index> positions(prior.size());
  std::iota(positions.begin(), positions.end(), Index{0});
  return {.caption = std::move(caption),
          .row_header = "Parameter",
          .rows = std::move(positions),
          .label = [&](Index d) { return prior[static_cast<std::size_t>(d)].name; }};
}

// A method's samples (n) of parameter d, of all seeds.
Vector samples_of(const ReportData& data, const std::string& method, Index d) {
  return pooled(data.runs_of(method),
                [d](const EvaluatedRun* run) -> Vector { return run->evaluation.theta.col(d); });
}

// The same of a periodic parameter moved by periods to where they lie around their mean.
Vector unwrapped_samples_of(const ReportData& data, const std::string& method, Index d) {
  Vector samples = samples_of(data, method, d);
  const double period = data.period_of(d);
  if (!(period > 0.0)) return samples;
  const double mean = data.summary_of(d, samples).mean;
  return samples.unaryExpr([&](double v) { return mean + std::remainder(v - mean, period); });
}

// The cell of a parameter that the method takes as known, as its footnote says.
Cell known_cell(Cell cell = {}) {
  cell.notes.emplace_back("not inferred by this method, which takes it as known");
  return cell;
}

std::string prior_text(const inference::Marginal& m) {
  using enum inference::Marginal::Kind;
  if (m.kind == uniform) return interval_text(m.a, m.b);
  if (m.kind == log_uniform) return interval_text(m.a, m.b) + ", log-uniform";
  const std::string cut = m.is_cut() ? " in " + interval_text(m.lower(), m.upper()) : "";
  if (m.kind == gamma || m.kind == beta) {
    return fmt::format("{}({:.4g}, {:.4g}){}", name_of(m.kind), m.a, m.b, cut);
  }
  return fmt::format("{}N({:.4g}, {:.4g}²){}", m.is_log() ? "exp " : "", m.a, m.b, cut);
}

Cell posterior_cell(const ReportData& data, const std::string& method, Index d) {
  const double period = data.period_of(d);
  const Vector samples = samples_of(data, method, d);
  Cell cell =
      data.is_inferred(method, d) ? Cell(data.summary_of(d, samples)) : known_cell(samples(0));
  if (period > 0.0) {
    cell.notes.push_back(
        fmt::format("modulo {:.4g}: values that far apart are the same system", period));
  }
  return cell;
}

// Rows with their units.
TableOf<Index> table_with_units(const ReportData& data, const char* of_posteriors) {
  auto table = table_of_parameters(
      data, fmt::format("Domain parameters: {} of the posterior, all seeds.", of_posteriors));
  table.add("unit", [&](Index d) { return data.marginal(d).unit; });
  return table;
}

// Nominal, truth and the first references.
std::vector<analysis::MarkedPoint> marked_points(const ReportData& data) {
  using analysis::LegendMark, analysis::LineStyle;
  std::vector<analysis::MarkedPoint> points;
  const auto mark = [&](const std::string& name, LegendMark shape, const char* color,
                        LineStyle line) {
    const auto found = std::ranges::find(data.baseline.points, name, &BaselinePoint::name);
    if (found != data.baseline.points.end()) {
      points.push_back({name, found->theta, shape, color, line});
    }
  };
  mark("nominal", LegendMark::triangle, analysis::kNominalColor, LineStyle::dashed);
  mark("truth", LegendMark::diamond, analysis::kTruthColor, LineStyle::solid);
  const auto& references = data.plan.study.references;
  for (std::size_t i = 0; i < std::min(references.size(), analysis::kMaxReferences); ++i) {
    mark(references[i].name, LegendMark::square, analysis::kReferenceColors[i],
         LineStyle::dash_dotted);
  }
  return points;
}

// The prior's distribution function at theta (n, D), of the shown parameters.
RowMatrix place_in_prior(const inference::Prior& prior, const RowMatrix& theta,
                         const std::vector<Index>& shown) {
  return prior.to_normal(theta)(Eigen::all, shown).unaryExpr([](double u) {
    return normal_cdf(u);
  });
}

// "pole_mass [kg]", and a line for each method: "NPE: 0.812, 90 % in [0.31, 1.02]".
std::string tip_of(const ReportData& data, Index d) {
  const inference::Marginal& parameter = data.plan.study.prior[static_cast<std::size_t>(d)];
  std::string words = fmt::format("{} [{}]", parameter.name, parameter.unit);
  for (const std::string& method : data.methods) {
    const RowMatrix quantiles = interval_quantiles(unwrapped_samples_of(data, method, d));
    words += fmt::format("\n{}: {:.3g}, 90 % in [{:.3g}, {:.3g}]", method, quantiles(0, 2),
                         quantiles(0, 0), quantiles(0, 4));
  }
  return words;
}

// Samples of all seeds; a periodic parameter's lie on the side of their mean, up to the border.
RowMatrix samples_within(const ReportData& data, const std::string& method) {
  RowMatrix theta;
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    const inference::Marginal& parameter = data.plan.study.prior[static_cast<std::size_t>(d)];
    const Vector samples = unwrapped_samples_of(data, method, d);
    theta.conservativeResize(samples.size(), d + 1);
    theta.col(d) = samples.cwiseMax(parameter.lower()).cwiseMin(parameter.upper());
  }
  return theta;
}

analysis::IntervalPlot plot_of(const ReportData& data) {
  const Study& study = data.plan.study;
  const inference::Prior prior(study.prior);
  const std::vector<Index> shown = shown_parameters(study);
  analysis::IntervalPlot plot;
  plot.name = "intervals";
  plot.title = "place in the prior: share of it that lies below";
  for (const Index d : shown) {
    plot.parameters.push_back(study.prior[static_cast<std::size_t>(d)].name);
    plot.tips.push_back(tip_of(data, d));
  }
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.sets.push_back(
        {method, interval_quantiles(place_in_prior(prior, samples_within(data, method), shown))});
  }
  plot.points = marked_points(data);
  for (analysis::MarkedPoint& point : plot.points) {
    point.place = place_in_prior(prior, point.place.transpose(), shown).transpose().eval();
  }
  return plot;
}

std::string note_on_periods(const ReportData& data) {
  const std::vector<Index> shown = shown_parameters(data.plan.study);
  const bool has_any = std::ranges::any_of(shown, [&](Index d) { return data.period_of(d) > 0.0; });
  return has_any ? " Of a periodic parameter, up to the border of its range." : "";
}

// Values of a parameter as they are drawn; NaN where a log has none.
Vector drawn(const inference::Marginal& m, const Vector& values) {
  return m.is_log() ? Vector(values.array().log10()) : values;
}

// Where the methods' samples are, within the prior; one that isn't uniform is shown over three
// deviations.
analysis::PairParameter axis_of(const analysis::PairPlot& plot, const inference::Marginal& m,
                                Index d) {
  const auto [low, high] = m.central_range(3.0);
  const Vector most = drawn(m, Vector{{low, high}});
  analysis::Range range;
  for (const analysis::SampleSet& set : plot.sets) {
    const std::vector<double> sorted = sorted_finite(set.samples.col(d));
    if (sorted.empty()) continue;
    for (const double level : {0.005, 0.995}) range.add(quantile_of_sorted(sorted, level));
  }
  range = range.widened(0.15);
  const double lower = std::clamp(range.lower, most(0), most(1));
  const double upper = std::clamp(range.upper, most(0), most(1));
  const std::string label = m.is_log() ? "log₁₀ " + m.name : m.name;
  if (!(lower < upper)) return {label, m.unit, most(0), most(1)};
  return {label, m.unit, lower, upper};
}

}  // namespace

/// Prior, baselines and posteriors: mean and deviation, circular for a periodic parameter.
std::optional<Table> parameters_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  auto table = table_with_units(data, "mean and standard deviation");
  table.add("prior", [&](Index d) { return prior_text(data.marginal(d)); });
  for (const BaselinePoint& point : data.baseline.points) {
    table.add(point.name, [&](Index d) { return point.theta(d); });
  }
  table.add_each(data.methods, [&](const std::string& method, Index d) {
    return posterior_cell(data, method, d);
  });
  for (const Finding& finding : data.dataset) {
    table.last_notes.push_back(join(lines_of(finding), ". "));
  }
  return table.make();
}

/// What 90 % of each posterior's samples lie in, parameter by parameter: 5 % and 95 % quantiles.
std::optional<Table> intervals_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  auto table = table_with_units(data, "5 % and 95 % quantiles");
  table.add_each(data.methods, [&](const std::string& method, Index d) -> Cell {
    if (!data.is_inferred(method, d)) return {};
    return interval_text(unwrapped_samples_of(data, method, d));
  });
  return table.make();
}

/// Contraction of each parameter (findings.h).
std::optional<Table> contraction_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  auto table = table_of_parameters(
      data,
      "What the data tell about each parameter: 1 - posterior variance / prior variance, mean and "
      "standard deviation over seeds. 0: nothing, 1: all; below 0: the posterior is wider. Of "
      "logarithms where the prior is log_uniform or log_normal.");
  table.add_each(data.methods, [&](const std::string& method, Index d) {
    return data.is_inferred(method, d) ? Cell(analysis::summarize(contraction(data, method, d)))
                                       : known_cell();
  });
  return table.make();
}

/// Credible intervals of each method's posterior within the prior.
std::optional<ReportedFigure> interval_figure(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  const analysis::IntervalPlot plot = plot_of(data);
  analysis::IntervalPlot narrow = plot;
  narrow.name += "_narrow";
  narrow.width = analysis::kNarrowWidth;
  return {{figure_of(plot),
           fmt::format("What the posteriors say of each parameter, all seeds: median, 50 % "
                       "interval (thick) and 90 % interval, within what the prior allows "
                       "(grey).{}{}",
                       note_on_periods(data), left_out_parameters(data.plan.study)),
           figure_of(narrow)}};
}

/// Pair plot of the first seed's posterior samples of each method.
std::optional<ReportedFigure> pair_figure(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  analysis::PairPlot plot;
  plot.name = "pair_plot";
  for (const std::string& method : drawn_methods(data.methods)) {
    plot.sets.push_back({method, data.runs_of(method).front()->evaluation.theta});
  }
  plot.points = marked_points(data);
  Index d = 0;
  for (const inference::Marginal& m : data.plan.study.prior) {
    for (analysis::SampleSet& set : plot.sets) {
      set.samples.col(d) = drawn(m, set.samples.col(d)).eval();
    }
    for (analysis::MarkedPoint& point : plot.points) {
      point.place(d) = drawn(m, point.place.segment(d, 1))(0);
    }
    plot.parameters.push_back(axis_of(plot, m, d));
    ++d;
  }
  plot.selection = shown_parameters(data.plan.study);
  return {{figure_of(plot), fmt::format("Posterior samples of seed {}, where they are.{}",
                                        data.seeds.front(), left_out_parameters(data.plan.study))}};
}

}  // namespace npdr::pipeline
