#include "analysis/trajectory_plot.h"

#include <algorithm>

namespace npdr::analysis {
namespace {

constexpr Index kMaxRollouts = 6;
constexpr Index kMaxChannels = 12;
constexpr double kRowMargin = 0.06;  // of a row's range, below and above it

// The time, then for each channel the recorded series of rollout h and lower, median and upper of
// each method; at a stride that keeps at most max_points of them.
DataTable table_of(const TrajectoryPlot& plot, const Target& target, Index h,
                   const std::vector<Index>& channels) {
  const auto k = static_cast<std::size_t>(h);
  const Index num_steps = target.num_steps() / plot.store_every;
  const Index stride = (num_steps + plot.max_points - 1) / plot.max_points;
  const Index rows = (num_steps + stride - 1) / stride;
  const auto stored = Eigen::seqN(0, rows, stride);
  const auto recorded = Eigen::seqN(plot.store_every, rows, stride * plot.store_every);
  const auto columns = static_cast<Index>(1 + channels.size() * (1 + 3 * plot.predictions.size()));
  DataTable table{fmt::format("rollout_{}", h), target.rollouts[k].name + ": time [s]",
                  RowMatrix(rows, columns)};
  Index column = 0;
  for (Index i = 0; i < rows; ++i) {
    table.values(i, column) = target.dt * static_cast<double>(recorded[i]);
  }
  for (const Index c : channels) {
    const Channel& channel = target.state_channels[static_cast<std::size_t>(c)];
    table.comment += fmt::format("; {} [{}] recorded", channel.label, channel.unit);
    table.values.col(++column) = target.rollouts[k].states(recorded, c);
    for (const Prediction& p : plot.predictions) {
      table.comment += ", " + p.name + " lower median upper";
      for (const auto* part : {&p.bands.lower, &p.bands.median, &p.bands.upper}) {
        require<ShapeError>(
            static_cast<Index>(part->size()) == target.num_rollouts() &&
                (*part)[k].rows() == num_steps && (*part)[k].cols() == target.num_states(),
            "trajectory plot '{}': bands of '{}' must be {} rollouts of shape ({}, {})", plot.name,
            p.name, target.num_rollouts(), num_steps, target.num_states());
        table.values.col(++column) = (*part)[k](stored, c);
      }
    }
  }
  return table;
}

// One bad sample must not flatten everything else, so predictions widen the range only so far, and
// medians, which say more, farther than bands.
Range shown_range(const TrajectoryPlot& plot, const Target& target,
                  const std::vector<Index>& rollouts, Index channel) {
  Range recorded;
  for (const Index h : rollouts) {
    recorded.add(target.rollouts[static_cast<std::size_t>(h)].states.col(channel));
  }
  Range shown = recorded;
  const auto widen = [&](const RowMatrix& series, double reach) {
    const Range limit = recorded.widened(reach);
    for (const double v : series.col(channel)) shown.add(std::clamp(v, limit.lower, limit.upper));
  };
  for (const Prediction& p : plot.predictions) {
    for (const Index h : rollouts) {
      const auto k = static_cast<std::size_t>(h);
      widen(p.bands.lower[k], 1.0);
      widen(p.bands.median[k], 3.0);
      widen(p.bands.upper[k], 1.0);
    }
  }
  const double margin = kRowMargin * recorded.length();
  return {shown.lower - margin, shown.upper + margin};
}

// Bands at the back; the target domain's series thin at the front, so that a median that agrees
// with it still shows beside it.
std::vector<Series> series_of(const std::string& table, Index recorded, Index num_methods) {
  std::vector<Series> bands, lines;
  for (Index k = num_methods; k-- > 0;) {
    const Index lower = recorded + 1 + 3 * k;
    bands.push_back({SeriesKind::band, table, {0, lower, lower + 2}, kMethodColors[k], 0.0, 0.25});
    lines.push_back({SeriesKind::line, table, {0, lower + 1}, kMethodColors[k], 1.9});
  }
  lines.push_back({SeriesKind::line, table, {0, recorded}, kTruthColor, 1.1});
  bands.insert(bands.end(), lines.begin(), lines.end());
  return bands;
}

std::vector<LegendEntry> legend_of(const TrajectoryPlot& plot) {
  std::vector<LegendEntry> legend = {{LegendMark::line, kTruthColor, "target domain"}};
  for (const Prediction& p : plot.predictions) {
    legend.push_back({LegendMark::band, kMethodColors[legend.size() - 1],
                      fmt::format("{}: median, {:.3g} % of {} samples", p.name,
                                  100.0 * p.bands.coverage, p.bands.num_samples)});
  }
  return legend;
}

}  // namespace

Figure figure_of(const TrajectoryPlot& plot, const Target& target) {
  require(
      plot.predictions.size() <= kMaxMethods && plot.max_points >= 2 && plot.store_every >= 1,
      "trajectory plot '{}': {} methods, max_points = {}, store_every = {}; must be at most {}, "
      ">= 2 and >= 1",
      plot.name, plot.predictions.size(), plot.max_points, plot.store_every, kMaxMethods);
  const std::string where = fmt::format("trajectory plot '{}': ", plot.name);
  const std::vector<Index> rollouts =
      check_selection(where + "rollout", plot.rollouts, target.num_rollouts(), 1, kMaxRollouts);
  const std::vector<Index> channels =
      check_selection(where + "channel", plot.channels, target.num_states(), 1, kMaxChannels);
  Figure figure{.name = plot.name,
                .columns = rollouts.size(),
                .sizes = {rollouts.size() > 3 ? 190.0 : 300.0, 104.0, 10.0, 11.0, 9.0},
                .legend = legend_of(plot)};
  for (const Index h : rollouts) figure.tables.push_back(table_of(plot, target, h, channels));
  const double duration = target.dt * static_cast<double>(target.num_steps());
  const auto num_methods = static_cast<Index>(plot.predictions.size());
  Index recorded = 1;
  for (const Index c : channels) {
    const Channel& channel = target.state_channels[static_cast<std::size_t>(c)];
    const Axis y =
        make_axis(shown_range(plot, target, rollouts, c), channel.label, channel.unit, 3);
    for (const DataTable& table : figure.tables) {
      figure.panels.push_back({.x = make_axis({0.0, duration}, "time", "s", 3),
                               .y = y,
                               .series = series_of(table.name, recorded, num_methods)});
    }
    recorded += 1 + 3 * num_methods;
  }
  for (std::size_t i = 0; i < rollouts.size(); ++i) {
    figure.panels[i].title = target.rollouts[static_cast<std::size_t>(rollouts[i])].name;
  }
  return figure;
}

}  // namespace npdr::analysis
