/// Figures as they are drawn.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "analysis/figure.h"
#include "analysis/gnuplot.h"
#include "tests/analysis/markup_check.h"
#include "tests/temp_folder.h"

namespace npdr::analysis {

/// What the drawing of a figure leaves.
struct Drawn {
  std::string script, svg;
  std::map<std::string, std::string> data;  ///< files of the data, by name

  /// Number of what gnuplot has plotted: lines, bands, sets of points.
  int num_plots() const { return count_of(svg, "<g id=\"gnuplot_plot_"); }
};

/// Draws a figure, whose SVG must be well-formed and beside a PNG.
inline Drawn drawn(const Figure& figure) {
  const TempFolder folder;
  const FigureFiles files = write_figure(figure, folder.path());
  Drawn result{text_of(files.script), text_of(files.svg), {}};
  EXPECT_EQ(markup_error(result.svg), "");
  EXPECT_TRUE(is_png(text_of(files.png)));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    if (entry.path().extension() == ".dat") {
      result.data[entry.path().filename()] = text_of(entry.path());
    }
  }
  return result;
}

}  // namespace npdr::analysis
