/// The gnuplot script of a trajectory plot (analysis/trajectory_plot.h).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "analysis/axis.h"
#include "analysis/plot_layout.h"
#include "analysis/trajectory_plot.h"

namespace npdr::analysis {

/// Lays out the panels of a plot that has been checked: row r shows channel channels[r], column c
/// rollout rollouts[c].
class TrajectoryPlotScript {
 public:
  TrajectoryPlotScript(const TrajectoryPlot& plot, const Target& target,
                       const std::vector<Index>& rollouts, const std::vector<Index>& channels);

  double width() const;   ///< [px]
  double height() const;  ///< [px]
  std::string commands() const;

  /// Name of the data file of column c. Its columns: the time, then for each shown channel the
  /// recorded value, and lower, median and upper of each method.
  std::string data_file(std::size_t c) const;

 private:
  double panel_width() const;
  double top() const;
  Panel area(std::size_t r, std::size_t c) const;
  void place_legend();
  std::string legend() const;
  std::string panel(std::size_t r, std::size_t c) const;
  std::string y_label(std::size_t r, const Axis& axis) const;
  std::string curves(std::size_t r, std::size_t c, double x_scale, double y_scale) const;
  std::pair<double, double> recorded_range(Index channel) const;
  std::pair<double, double> shown_range(Index channel) const;
  std::size_t recorded_column(std::size_t r) const;

  const TrajectoryPlot& plot_;
  const Target& target_;
  const std::vector<Index>& rollouts_;
  const std::vector<Index>& channels_;
  std::vector<LegendEntry> entries_;
  std::vector<std::pair<double, double>> positions_;  // of the entries
  double legend_lines_ = 1.0;
  double legend_width_ = 0.0;
};

}  // namespace npdr::analysis
