/// Figures by gnuplot: one script makes an SVG for the report, a PDF for papers and a PNG for
/// everything else.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/types.h"

namespace npdr::analysis {

/// Commands that draw a figure.
struct GnuplotScript {
  std::string name;          ///< of its files: letters, digits, '_' and '-'
  int width = 640;           ///< [px] of the SVG; the PNG has twice as many
  int height = 480;          ///< [px]
  std::string commands;      ///< gnuplot's, after terminal and output are set; data files by name
  std::string overlay = {};  ///< SVG elements in front of all others
};

/// A figure's script and what gnuplot made of it.
struct FigureFiles {
  std::filesystem::path script;
  std::filesystem::path svg;
  std::filesystem::path png;
  std::filesystem::path pdf;
};

/// Writes <name>.gp into `directory`, where the data files are already, and runs it there for
/// <name>.svg, <name>.png and <name>.pdf. Text is plain (no markup), encoding UTF-8; the user's
/// gnuplot settings aren't read. `gnuplot -c <name>.gp png <name>.png` in that folder repeats it by
/// hand. Throws InputError for a name that can't be a file's; Error when gnuplot is missing, fails
/// (with what it said) or leaves no file.
FigureFiles render_script(const GnuplotScript& script, const std::filesystem::path& directory,
                          const std::string& program = "gnuplot");

/// `text` as a string of gnuplot's language: in single quotes, where nothing but the quote itself
/// is special. Quotes in the text become typographic ones (gnuplot 5 misreads two doubled quotes in
/// a row), line breaks and tabulators blanks; what else isn't printable is replaced.
std::string gnuplot_string(std::string_view text);

/// Writes `values` (rows, columns) for gnuplot: `comment` in the first line, then a line per row
/// with all digits; NaN where a value isn't finite, which gnuplot skips.
void write_data_file(const std::filesystem::path& path, std::string_view comment,
                     const RowMatrix& values);

}  // namespace npdr::analysis
