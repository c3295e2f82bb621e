#include "analysis/trajectory_plot_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace npdr::analysis {
namespace {

// Sizes in pixels.
constexpr double kPanelHeight = 104.0;
constexpr double kGap = 10.0;
constexpr double kTop = 8.0;
constexpr double kLeft = 84.0;
constexpr double kRight = 16.0;
constexpr double kBottom = 44.0;
constexpr double kTitleHeight = 22.0;
constexpr double kLegendLine = 19.0;
constexpr double kFont = 11.0;
constexpr double kTickFont = 9.0;

}  // namespace

TrajectoryPlotScript::TrajectoryPlotScript(const TrajectoryPlot& plot, const Target& target,
                                           const std::vector<Index>& rollouts,
                                           const std::vector<Index>& channels)
    : plot_(plot), target_(target), rollouts_(rollouts), channels_(channels) {
  entries_.push_back({LegendMark::line, kTruthColor, "target domain"});
  for (std::size_t k = 0; k < plot.predictions.size(); ++k) {
    const Prediction& p = plot.predictions[k];
    entries_.push_back({LegendMark::band, kMethodColors[k],
                        fmt::format("{}: median, {:.3g} % of {} samples", p.name,
                                    100.0 * p.bands.coverage, p.bands.num_samples)});
  }
  place_legend();
}

double TrajectoryPlotScript::panel_width() const { return rollouts_.size() > 3 ? 190.0 : 300.0; }

double TrajectoryPlotScript::width() const {
  const auto count = static_cast<double>(rollouts_.size());
  return std::max(kLeft + count * (panel_width() + kGap) - kGap, legend_width_) + kRight;
}

double TrajectoryPlotScript::top() const {
  return kTop + legend_lines_ * kLegendLine + kTitleHeight;
}

double TrajectoryPlotScript::height() const {
  const auto count = static_cast<double>(channels_.size());
  return top() + count * (kPanelHeight + kGap) - kGap + kBottom;
}

Panel TrajectoryPlotScript::area(std::size_t r, std::size_t c) const {
  return {kLeft + static_cast<double>(c) * (panel_width() + kGap),
          top() + static_cast<double>(r) * (kPanelHeight + kGap), panel_width(), kPanelHeight};
}

// Entries side by side where the panels leave room, in further lines otherwise.
void TrajectoryPlotScript::place_legend() {
  const double available = width() - kRight;
  double x = kLeft, y = kTop + 0.5 * kLegendLine;
  for (const LegendEntry& e : entries_) {
    const double needed = legend_entry_width(e, kFont);
    if (x > kLeft && x + needed > available) {
      x = kLeft;
      y += kLegendLine;
      legend_lines_ += 1.0;
    }
    positions_.emplace_back(x, y);
    legend_width_ = std::max(legend_width_, x + needed);
    x += needed + 2.0 * kFont;
  }
}

std::string TrajectoryPlotScript::legend() const {
  std::string commands;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    commands += legend_commands(PlotLayout(width(), height()), entries_[i], positions_[i].first,
                                positions_[i].second, kFont);
  }
  return commands;
}

std::string TrajectoryPlotScript::commands() const {
  std::string script =
      "set multiplot\nunset key\nset border 31 lw 0.8 lc rgb '#555555'\n" + legend();
  for (std::size_t r = 0; r < channels_.size(); ++r) {
    for (std::size_t c = 0; c < rollouts_.size(); ++c) {
      script += panel(r, c) + "unset label\nunset arrow\nunset object\n";
    }
  }
  return script + "unset multiplot\n";
}

std::string TrajectoryPlotScript::data_file(std::size_t c) const {
  return fmt::format("{}_rollout_{}.dat", plot_.name, rollouts_[c]);
}

// Counted from 1, as gnuplot does.
std::size_t TrajectoryPlotScript::recorded_column(std::size_t r) const {
  return 2 + r * (1 + 3 * plot_.predictions.size());
}

std::pair<double, double> TrajectoryPlotScript::recorded_range(Index channel) const {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Index h : rollouts_) {
    for (const double v : target_.rollouts[static_cast<std::size_t>(h)].states.col(channel)) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  return {low, high};
}

// One bad sample must not flatten everything else, so predictions widen the range only so far, and
// medians, which say more, farther than bands.
std::pair<double, double> TrajectoryPlotScript::shown_range(Index channel) const {
  const auto [low, high] = recorded_range(channel);
  const double span = high > low ? high - low : std::max(1e-3, std::abs(high));
  double lowest = low, highest = high;
  // Comparisons with NaN are false, so bands without samples don't count.
  const auto widen = [&, low = low, high = high](const RowMatrix& series, double reach) {
    for (const double v : series.col(channel)) {
      const double shown = std::clamp(v, low - reach * span, high + reach * span);
      if (shown < lowest) lowest = shown;
      if (shown > highest) highest = shown;
    }
  };
  for (const Prediction& p : plot_.predictions) {
    for (const Index h : rollouts_) {
      const auto k = static_cast<std::size_t>(h);
      widen(p.bands.lower[k], 1.0);
      widen(p.bands.median[k], 3.0);
      widen(p.bands.upper[k], 1.0);
    }
  }
  return {lowest - 0.06 * span, highest + 0.06 * span};
}

std::string TrajectoryPlotScript::panel(std::size_t r, std::size_t c) const {
  const PlotLayout layout(width(), height());
  const Panel place = area(r, c);
  const double duration = target_.dt * static_cast<double>(target_.num_steps());
  const auto [low, high] = shown_range(channels_[r]);
  const Axis x = make_axis(0.0, duration, "s", 3);
  const Axis y =
      make_axis(low, high, target_.state_channels[static_cast<std::size_t>(channels_[r])].unit, 3);
  const bool is_bottom = r + 1 == channels_.size();
  const std::string tics = fmt::format("scale 0.5 font ',{}' textcolor rgb '#333333'", kTickFont);
  const double middle = place.left + 0.5 * place.width;
  std::string script = layout.margins(place);
  script += fmt::format("set xrange [0:{}]\nset yrange [{}:{}]\n", duration * x.scale,
                        low * y.scale, high * y.scale);
  script += tics_command(x, "x", tics, is_bottom) + tics_command(y, "y", tics, c == 0);
  if (r == 0) {
    const std::string& name = target_.rollouts[static_cast<std::size_t>(rollouts_[c])].name;
    script += layout.text(middle, place.top - 0.5 * kTitleHeight,
                          elide_text(name, place.width, kTickFont),
                          fmt::format("center font ',{}'", kTickFont));
  }
  if (is_bottom) {
    script += layout.text(middle, place.top + place.height + 31.0, "time " + x.unit,
                          fmt::format("center font ',{}'", kFont));
  }
  if (c == 0) script += y_label(r, y);
  return script + curves(r, c, x.scale, y.scale);
}

std::string TrajectoryPlotScript::y_label(std::size_t r, const Axis& axis) const {
  const Panel place = area(r, 0);
  const Channel& channel = target_.state_channels[static_cast<std::size_t>(channels_[r])];
  std::vector<std::string> lines = wrap_text(channel.label, place.height, kFont);
  if (!axis.unit.empty()) lines.push_back(axis.unit);
  double x = place.left - 44.0 - 1.25 * kFont * (static_cast<double>(lines.size()) - 1.0);
  std::string commands;
  for (const std::string& line : lines) {
    commands += PlotLayout(width(), height())
                    .text(x, place.top + 0.5 * place.height, line,
                          fmt::format("center rotate by 90 font ',{}'", kFont));
    x += 1.25 * kFont;
  }
  return commands;
}

// Bands at the back; the target domain's series thin at the front, so that a median that agrees
// with it still shows beside it.
std::string TrajectoryPlotScript::curves(std::size_t r, std::size_t c, double x_scale,
                                         double y_scale) const {
  const std::string begin =
      fmt::format("{} using (${}*{}):", gnuplot_string(data_file(c)), 1, x_scale);
  const auto value = [&](std::size_t column) { return fmt::format("(${}*{})", column, y_scale); };
  std::string bands, medians;
  for (std::size_t k = plot_.predictions.size(); k-- > 0;) {
    const std::size_t lower = recorded_column(r) + 1 + 3 * k;
    bands +=
        fmt::format("{}{}:{} with filledcurves fc rgb '{}' fs transparent solid 0.25 noborder, ",
                    begin, value(lower), value(lower + 2), kMethodColors[k]);
    medians += fmt::format("{}{} with lines lw 1.9 lc rgb '{}', ", begin, value(lower + 1),
                           kMethodColors[k]);
  }
  return fmt::format("plot {}{}{}{} with lines lw 1.1 lc rgb '{}'\n", bands, medians, begin,
                     value(recorded_column(r)), kTruthColor);
}

}  // namespace npdr::analysis
