/// Numbers as people read them in a table: a mean with its spread at sensible digits.
#pragma once

#include <string>

namespace npdr::analysis {

/// Markup of a number.
enum class NumberStyle {
  plain,  ///< UTF-8 text, for Markdown and HTML
  latex,  ///< a LaTeX formula
};

/// "0.263 ± 0.004", or for magnitudes >= 1000 or < 0.001, in the style of Table A2,
/// "[1.07 ± 0.03]e+3"; "2464.54 ± 0.02" where std is below 1 and |mean| below a million. The larger
/// of |mean| and std gets three significant digits, and the smaller as many decimals, but at least
/// as many as show one digit of std (at most eight). A std that isn't finite is left out ("0.263");
/// a mean that isn't is "n/a".
std::string mean_std_text(double mean, double std, NumberStyle style);

/// A whole number below a million as it is ("5000"), any other at up to four significant digits
/// ("8.4", "2.9e-4"). "n/a" for NaN, "inf" and "-inf".
std::string number_text(double value, NumberStyle style);

/// Size of one step of the last digit that mean_std_text() shows of a finite mean.
double last_digit(double mean, double std);
/// The same of number_text(); 0: all digits are shown.
double last_digit(double value);

}  // namespace npdr::analysis
