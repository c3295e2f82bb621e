/// The SVG that gnuplot writes, made smaller and fit for a page with others of its kind.
#pragma once

#include <string>
#include <string_view>

namespace npdr::analysis {

/// The same picture with runs of filled circles as plain <circle> elements in one group (a third of
/// the bytes, several times faster to show) and without gnuplot's <title> and <desc>, which
/// browsers pop up over the plot.
std::string tidy_svg(std::string_view svg);

/// The <svg> element alone, without what comes before it in a file, for use inside an HTML page:
/// all ids and references to them begin with `prefix`, so that figures of one page don't share
/// them, and `label` says what the figure shows to those who don't see it. Throws InputError when
/// there is no <svg> element.
std::string inline_svg(std::string_view svg, std::string_view prefix, std::string_view label);

}  // namespace npdr::analysis
