/// What a page's script knows of a figure: invisible shapes over the drawing.
#pragma once

#include <string>

#include "analysis/figure.h"
#include "analysis/figure_layout.h"

namespace npdr::analysis {

/// A group "overlay": a rectangle for each panel that has series, with the
/// ends and titles of its axes as data attributes (as shown: scaled, in the shown unit); one for
/// each tip, whose words browsers show beside the pointer; and an empty group for each entry of the
/// legend, with its color and words.
std::string overlay_of(const Figure& figure, const FigureLayout& layout);

}  // namespace npdr::analysis
