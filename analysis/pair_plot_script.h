/// The gnuplot script of a pair plot (analysis/pair_plot.h).
#pragma once

#include <string>
#include <vector>

#include "analysis/axis.h"
#include "analysis/pair_plot.h"
#include "analysis/plot_layout.h"

namespace npdr::analysis {

/// Whether samples (n) of a parameter all have the same value: a method took it as known.
bool is_constant(const Eigen::Ref<const Vector>& samples);

/// Lays out the lower triangle of panels, its labels and its legend, for `shown` parameters of a
/// plot that has been checked, both of which must outlive it. Row r and column c of the triangle
/// show shown[r] over shown[c].
class PairPlotScript {
 public:
  /// `tops`: where the axis of each shown parameter's marginal density ends.
  PairPlotScript(const PairPlot& plot, const std::vector<Index>& shown,
                 const std::vector<double>& tops);

  double width() const { return width_; }    ///< [px]
  double height() const { return height_; }  ///< [px]
  std::string commands() const;

  /// Name of the data file with the scattered samples of set k: shown parameter i in column i.
  std::string samples_file(std::size_t k) const;
  /// Name of the data file with the marginals of set k: position and density of shown parameter i
  /// in columns 2 i and 2 i + 1.
  std::string density_file(std::size_t k) const;

 private:
  // Sizes in pixels; points and marks in gnuplot's unit.
  struct Sizes {
    double panel, gap, font, tick_font, point, mark;
  };
  static Sizes sizes_for(std::size_t num_parameters);

  void set_margins();
  void make_room_for_legend();
  Panel area(std::size_t r, std::size_t c) const;
  std::string legend() const;
  std::string panel(std::size_t r, std::size_t c) const;
  std::string marginal(std::size_t c) const;
  std::string scatter(std::size_t r, std::size_t c) const;
  std::string vertical_marks(std::size_t c) const;
  std::string constant_marks(std::size_t c) const;
  std::string point_marks(std::size_t r, std::size_t c) const;
  std::string x_label(std::size_t c) const;
  std::string y_label(std::size_t r) const;
  std::string tics_options() const;

  const PairPlot& plot_;
  const std::vector<Index>& shown_;
  std::vector<double> tops_;
  Sizes sizes_;
  std::vector<const PairParameter*> parameters_;  // the shown ones
  std::vector<Axis> axes_;
  std::vector<std::vector<std::string>> labels_;  // lines: the name, then the unit
  std::vector<LegendEntry> entries_;
  double tick_width_ = 0.0;
  double left_ = 0.0;
  double legend_left_ = 0.0;
  double width_ = 0.0;
  double height_ = 0.0;
};

}  // namespace npdr::analysis
