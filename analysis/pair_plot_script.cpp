#include "analysis/pair_plot_script.h"

#include <fmt/format.h>

#include <algorithm>

namespace npdr::analysis {
namespace {

constexpr double kEdge = 14.0;         // [px] around everything
constexpr double kTickGap = 10.0;      // [px] between tick labels and what is beside them
constexpr double kLineHeight = 1.25;   // of labels, in font sizes
constexpr double kLegendHeight = 1.7;  // of an entry, in font sizes

bool inside(const PairParameter& p, double value) { return value >= p.lower && value <= p.upper; }

std::size_t most_lines(const std::vector<std::vector<std::string>>& labels) {
  std::size_t most = 0;
  for (const auto& lines : labels) most = std::max(most, lines.size());
  return most;
}

std::string label_options(const char* placement, double font_size) {
  return fmt::format("{} font ',{}'", placement, font_size);
}

}  // namespace

bool is_constant(const Eigen::Ref<const Vector>& samples) {
  return samples.size() > 1 && (samples.array() == samples(0)).all();
}

// Smaller with more parameters, so that fifteen still fit on a screen.
PairPlotScript::Sizes PairPlotScript::sizes_for(std::size_t num_parameters) {
  if (num_parameters <= 4) return {150, 9, 11, 9, 0.35, 0.8};
  if (num_parameters <= 6) return {124, 8, 10.5, 9, 0.32, 0.7};
  if (num_parameters <= 9) return {98, 7, 9.5, 8, 0.28, 0.6};
  return {76, 6, 8.5, 7.5, 0.22, 0.55};
}

PairPlotScript::PairPlotScript(const PairPlot& plot, const std::vector<Index>& shown,
                               const std::vector<double>& tops)
    : plot_(plot), shown_(shown), tops_(tops), sizes_(sizes_for(shown.size())) {
  for (const Index d : shown) {
    const PairParameter& p = plot.parameters[static_cast<std::size_t>(d)];
    parameters_.push_back(&p);
    axes_.push_back(make_axis(p.lower, p.upper, p.unit));
    labels_.push_back(wrap_text(p.label, sizes_.panel, sizes_.font));
    if (!axes_.back().unit.empty()) labels_.back().push_back(axes_.back().unit);
  }
  for (std::size_t k = 0; k < plot.sets.size(); ++k) {
    entries_.push_back({LegendMark::dot, kMethodColors[k], plot.sets[k].name});
  }
  for (const PairPoint& point : plot.points) {
    const auto is_shown = [&](Index d) {
      return inside(plot.parameters[static_cast<std::size_t>(d)], point.theta(d));
    };
    if (std::ranges::any_of(shown, is_shown)) {
      entries_.push_back({point.mark, point.color, point.name});
    }
  }
  set_margins();
  make_room_for_legend();
}

void PairPlotScript::set_margins() {
  const auto lines = static_cast<double>(most_lines(labels_));
  const double label_height = kLineHeight * sizes_.font * lines;
  const auto count = static_cast<double>(parameters_.size());
  const double span = count * sizes_.panel + (count - 1.0) * sizes_.gap;
  double widest = 0.0;
  for (const Axis& axis : axes_) {
    for (const std::string& tick : axis.labels) {
      widest = std::max(widest, text_width(tick, sizes_.tick_font));
    }
  }
  tick_width_ = kTickGap + widest;
  left_ = kEdge + label_height + tick_width_;
  width_ = left_ + span + kEdge;
  height_ = kEdge + span + 2.6 * sizes_.tick_font + label_height + kEdge;
}

// The legend goes into the empty triangle at the top right, flush right. Where it is too wide for
// what the rows beside it leave free, the figure grows.
void PairPlotScript::make_room_for_legend() {
  double widest = 0.0;
  for (const LegendEntry& e : entries_) {
    widest = std::max(widest, legend_entry_width(e, sizes_.font));
  }
  const double bottom = kEdge + kLegendHeight * sizes_.font * static_cast<double>(entries_.size());
  std::size_t row = 0;
  while (row + 1 < parameters_.size() && area(row + 1, 0).top < bottom) ++row;
  const Panel beside = area(row, row);
  const double free_from = beside.left + beside.width + 2.0 * sizes_.gap;
  legend_left_ = std::max(free_from, width_ - kEdge - widest);
  width_ = std::max(width_, legend_left_ + widest + kEdge);
}

std::string PairPlotScript::samples_file(std::size_t k) const {
  return fmt::format("{}_samples_{}.dat", plot_.name, k + 1);
}

std::string PairPlotScript::density_file(std::size_t k) const {
  return fmt::format("{}_density_{}.dat", plot_.name, k + 1);
}

std::string PairPlotScript::commands() const {
  std::string script =
      "set multiplot\nunset key\nset border 31 lw 0.8 lc rgb '#555555'\n"
      "set offsets 0, 0, graph 0.08, 0\n";
  script += legend();
  for (std::size_t r = 0; r < parameters_.size(); ++r) {
    for (std::size_t c = 0; c <= r; ++c) {
      script += panel(r, c) + "unset label\nunset arrow\n";
    }
  }
  return script + "unset multiplot\n";
}

Panel PairPlotScript::area(std::size_t r, std::size_t c) const {
  const double pitch = sizes_.panel + sizes_.gap;
  return {left_ + static_cast<double>(c) * pitch, kEdge + static_cast<double>(r) * pitch,
          sizes_.panel, sizes_.panel};
}

std::string PairPlotScript::legend() const {
  const PlotLayout layout(width_, height_);
  double y = kEdge + 0.5 * kLegendHeight * sizes_.font;
  std::string commands;
  for (const LegendEntry& e : entries_) {
    commands += legend_commands(layout, e, legend_left_, y, sizes_.font);
    y += kLegendHeight * sizes_.font;
  }
  return commands;
}

std::string PairPlotScript::panel(std::size_t r, std::size_t c) const {
  const Axis& x = axes_[c];
  const PairParameter& p = *parameters_[c];
  const bool is_bottom = r + 1 == parameters_.size();
  std::string script = PlotLayout(width_, height_).margins(area(r, c));
  script += fmt::format("set xrange [{}:{}]\n", p.lower * x.scale, p.upper * x.scale);
  script += tics_command(x, "x", tics_options(), is_bottom);
  if (is_bottom) script += x_label(c);
  if (c == 0) script += y_label(r);
  return script + (r == c ? marginal(c) : scatter(r, c));
}

// Only the shape of a density is shown, so its own axis has no ticks.
std::string PairPlotScript::marginal(std::size_t c) const {
  std::string script = fmt::format("unset ytics\nset yrange [0:{}]\n", tops_[c]);
  script += vertical_marks(c) + constant_marks(c) + "plot ";
  for (std::size_t k = plot_.sets.size(); k-- > 0;) {
    const std::string curve = fmt::format("{} using (${}*{}):{}", gnuplot_string(density_file(k)),
                                          2 * c + 1, axes_[c].scale, 2 * c + 2);
    script += fmt::format(
        "{0} with filledcurves y1=0 fc rgb '{1}' fs transparent solid 0.22 noborder, "
        "{0} with lines lw 1.6 lc rgb '{1}'{2}",
        curve, kMethodColors[k], k > 0 ? ", " : "\n");
  }
  return script;
}

std::string PairPlotScript::scatter(std::size_t r, std::size_t c) const {
  const PairParameter& p = *parameters_[r];
  const Axis& y = axes_[r];
  std::string script = fmt::format("set yrange [{}:{}]\n", p.lower * y.scale, p.upper * y.scale);
  script += tics_command(y, "y", tics_options(), c == 0);
  script += point_marks(r, c) + "plot ";
  for (std::size_t k = plot_.sets.size(); k-- > 0;) {
    script += fmt::format("{} using (${}*{}):(${}*{}) with points pt 7 ps {} lc rgb {}{}",
                          gnuplot_string(samples_file(k)), c + 1, axes_[c].scale, r + 1, y.scale,
                          sizes_.point, translucent(kMethodColors[k], 0.55), k > 0 ? ", " : "\n");
  }
  return script;
}

std::string PairPlotScript::vertical_marks(std::size_t c) const {
  std::string script;
  for (const PairPoint& point : plot_.points) {
    const double x = point.theta(shown_[c]);
    if (!inside(*parameters_[c], x)) continue;
    script += fmt::format(
        "set arrow from first {0}, graph 0 to first {0}, graph 1 nohead front lw 1.4 dt {1} "
        "lc rgb '{2}'\n",
        x * axes_[c].scale, point.dash, point.color);
  }
  return script;
}

// A value that a method took as known has no density: a line stands for it.
std::string PairPlotScript::constant_marks(std::size_t c) const {
  std::string script;
  for (std::size_t k = 0; k < plot_.sets.size(); ++k) {
    const auto samples = plot_.sets[k].samples.col(shown_[c]);
    if (!is_constant(samples) || !inside(*parameters_[c], samples(0))) continue;
    script += fmt::format(
        "set arrow from first {0}, graph 0 to first {0}, graph 1 nohead back lw 1.6 lc rgb '{1}'\n",
        samples(0) * axes_[c].scale, kMethodColors[k]);
  }
  return script;
}

std::string PairPlotScript::point_marks(std::size_t r, std::size_t c) const {
  std::string script;
  for (const PairPoint& point : plot_.points) {
    const double x = point.theta(shown_[c]), y = point.theta(shown_[r]);
    if (!inside(*parameters_[c], x) || !inside(*parameters_[r], y)) continue;
    const std::string position =
        fmt::format("first {}, first {}", x * axes_[c].scale, y * axes_[r].scale);
    script += mark_command(point.mark, position, sizes_.mark, point.color);
  }
  return script;
}

std::string PairPlotScript::x_label(std::size_t c) const {
  const PlotLayout layout(width_, height_);
  const Panel panel = area(parameters_.size() - 1, c);
  double y = panel.top + panel.height + 2.2 * sizes_.tick_font + 0.9 * sizes_.font;
  std::string commands;
  for (const std::string& line : labels_[c]) {
    commands +=
        layout.text(panel.left + 0.5 * panel.width, y, line, label_options("center", sizes_.font));
    y += kLineHeight * sizes_.font;
  }
  return commands;
}

std::string PairPlotScript::y_label(std::size_t r) const {
  const PlotLayout layout(width_, height_);
  const Panel panel = area(r, 0);
  const auto lines = static_cast<double>(labels_[r].size());
  double x = panel.left - tick_width_ - kLineHeight * sizes_.font * (lines - 0.5);
  std::string commands;
  for (const std::string& line : labels_[r]) {
    commands += layout.text(x, panel.top + 0.5 * panel.height, line,
                            label_options("center rotate by 90", sizes_.font));
    x += kLineHeight * sizes_.font;
  }
  return commands;
}

std::string PairPlotScript::tics_options() const {
  return fmt::format("scale 0.5 font ',{}' textcolor rgb '#333333'", sizes_.tick_font);
}

}  // namespace npdr::analysis
