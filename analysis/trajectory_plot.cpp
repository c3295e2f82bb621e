#include "analysis/trajectory_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/file_stem.h"
#include "analysis/plot_layout.h"
#include "analysis/trajectory_plot_script.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

constexpr Index kMaxRollouts = 6;
constexpr Index kMaxChannels = 12;

std::vector<Index> selected(const char* what, const std::vector<Index>& wanted, Index available,
                            Index most, const std::string& name) {
  std::vector<Index> result = wanted;
  if (result.empty()) {
    result.resize(static_cast<std::size_t>(std::min(available, most)));
    std::iota(result.begin(), result.end(), Index{0});
  }
  if (static_cast<Index>(result.size()) > most) {
    throw InputError(fmt::format("trajectory plot '{}': {} {}s, must be at most {}", name,
                                 result.size(), what, most));
  }
  for (const Index i : result) {
    if (i >= 0 && i < available) continue;
    throw InputError(fmt::format("trajectory plot '{}': {} {} selected, must be in [0, {}]", name,
                                 what, i, available - 1));
  }
  return result;
}

void check(const TrajectoryPlot& plot, const Target& target) {
  check_file_stem("trajectory plot", plot.name);
  if (plot.predictions.size() > kMaxMethods || plot.max_points < 2 || plot.store_every < 1) {
    throw InputError(fmt::format(
        "trajectory plot '{}': {} methods, max_points = {}, store_every = {}; must be at most {}, "
        ">= 2 and >= 1",
        plot.name, plot.predictions.size(), plot.max_points, plot.store_every, kMaxMethods));
  }
  const Index num_steps = target.num_steps() / plot.store_every;
  for (const Prediction& p : plot.predictions) {
    for (const auto* part : {&p.bands.lower, &p.bands.median, &p.bands.upper}) {
      bool fits = static_cast<Index>(part->size()) == target.num_rollouts();
      for (const RowMatrix& series : *part) {
        fits = fits && series.rows() == num_steps && series.cols() == target.num_states();
      }
      if (fits) continue;
      throw ShapeError(
          fmt::format("trajectory plot '{}': bands of '{}' must be {} rollouts of "
                      "shape ({}, {})",
                      plot.name, p.name, target.num_rollouts(), num_steps, target.num_states()));
    }
  }
}

// What the columns of a data file hold.
std::string describe_columns(const TrajectoryPlot& plot, const Target& target,
                             const std::vector<Index>& channels) {
  std::string text = "time [s]";
  for (const Index c : channels) {
    const Channel& channel = target.state_channels[static_cast<std::size_t>(c)];
    text += fmt::format("; {} [{}] recorded", channel.label, channel.unit);
    for (const Prediction& p : plot.predictions) text += ", " + p.name + " lower median upper";
  }
  return text;
}

// The series of rollout h in these columns, at a stride that keeps at most max_points of them.
RowMatrix series_of(const TrajectoryPlot& plot, const Target& target, Index h,
                    const std::vector<Index>& channels) {
  const auto k = static_cast<std::size_t>(h);
  const Index num_steps = target.num_steps() / plot.store_every;
  const Index stride = (num_steps + plot.max_points - 1) / plot.max_points;
  const auto columns = static_cast<Index>(1 + channels.size() * (1 + 3 * plot.predictions.size()));
  RowMatrix series((num_steps + stride - 1) / stride, columns);
  for (Index i = 0; i < series.rows(); ++i) {
    const Index t = i * stride;
    const Index recorded_row = (t + 1) * plot.store_every;
    Index column = 0;
    series(i, column++) = target.dt * static_cast<double>(recorded_row);
    for (const Index c : channels) {
      series(i, column++) = target.rollouts[k].states(recorded_row, c);
      for (const Prediction& p : plot.predictions) {
        series(i, column++) = p.bands.lower[k](t, c);
        series(i, column++) = p.bands.median[k](t, c);
        series(i, column++) = p.bands.upper[k](t, c);
      }
    }
  }
  return series;
}

}  // namespace

FigureFiles write_trajectory_plot(const TrajectoryPlot& plot, const Target& target,
                                  const std::filesystem::path& directory) {
  check(plot, target);
  const std::vector<Index> rollouts =
      selected("rollout", plot.rollouts, target.num_rollouts(), kMaxRollouts, plot.name);
  const std::vector<Index> channels =
      selected("channel", plot.channels, target.num_states(), kMaxChannels, plot.name);
  const TrajectoryPlotScript script(plot, target, rollouts, channels);
  for (std::size_t c = 0; c < rollouts.size(); ++c) {
    const std::string& name = target.rollouts[static_cast<std::size_t>(rollouts[c])].name;
    write_data_file(directory / script.data_file(c),
                    name + ": " + describe_columns(plot, target, channels),
                    series_of(plot, target, rollouts[c], channels));
  }
  return render_figure({plot.name, static_cast<int>(std::lround(script.width())),
                        static_cast<int>(std::lround(script.height())), script.commands()},
                       directory);
}

}  // namespace npdr::analysis
