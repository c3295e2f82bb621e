#include "analysis/gnuplot.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "analysis/file_stem.h"
#include "analysis/svg.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/printable.h"
#include "core/shell_call.h"
#include "core/shell_text.h"

namespace npdr::analysis {
namespace {

constexpr const char* kFont = "sans-serif,11";

constexpr double kPixelsPerInch = 96.0;
constexpr double kTimeLimit = 300.0;  // [s] of a picture
constexpr int kNotFound = 127;        // status of a shell that doesn't find a program

// A PNG has twice the pixels of the SVG. Font sizes are pixels in SVG and points (4/3 pixels) in
// PNG and PDF, hence fontscales of 1.5 and 0.75; widths of lines and sizes of points are half as
// large in a PDF.

std::string file_text(const GnuplotScript& script) {
  return fmt::format(
             "# gnuplot -c {0}.gp svg {0}.svg\n"
             "# gnuplot -c {0}.gp png {0}.png\n"
             "# gnuplot -c {0}.gp pdf {0}.pdf\n"
             "set encoding utf8\n"
             "if (ARG1 eq 'png') {{\n"
             "  set terminal pngcairo noenhanced font '{1}' size {2},{3} fontscale 1.5 linewidth 2 "
             "pointscale 2 background rgb 'white'\n"
             "}}\n"
             "if (ARG1 eq 'pdf') {{\n"
             "  set terminal pdfcairo noenhanced font '{1}' size {6:.4f}in,{7:.4f}in fontscale "
             "0.75 background rgb 'white'\n"
             "}}\n"
             "if (ARG1 eq 'svg') {{\n"
             "  set terminal svg noenhanced font '{1}' size {4},{5} background rgb 'white'\n"
             "}}\n"
             "set output ARG2\n",
             script.name, kFont, 2 * script.width, 2 * script.height, script.width, script.height,
             script.width / kPixelsPerInch, script.height / kPixelsPerInch) +
         script.commands + "unset output\n";
}

enum class ImageFormat { svg, png, pdf };
constexpr const char* kFormatNames[] = {"svg", "png", "pdf"};

std::string with_overlay(std::string svg, const std::string& overlay) {
  const std::size_t end = svg.rfind("</svg>");
  return end == std::string::npos ? svg : svg.insert(end, overlay);
}

// The same picture is the same file, whenever it was drawn.
std::string without_date(std::string pdf) {
  constexpr std::string_view before = "/CreationDate (D:", date = "20000101000000";
  const std::size_t at = pdf.find(before);
  return at == std::string::npos ? pdf : pdf.replace(at + before.size(), date.size(), date);
}

std::filesystem::path run(const std::string& program, const GnuplotScript& script,
                          const std::filesystem::path& directory, ImageFormat format) {
  const std::string format_name = kFormatNames[static_cast<std::size_t>(format)];
  const std::filesystem::path path = directory / (script.name + "." + format_name);
  AtomicFile file(path);  // another report may be drawing the same figure
  // -d, and no GNUTERM: without the user's settings, so that a figure looks the same for everybody.
  // In UTC: how far another zone is from it stands in a PDF.
  const std::string command = shell_text(
      {program, "-d", "-c", script.name + ".gp", format_name, file.temporary().filename()});
  const CallResult result =
      run_shell({{"unset GNUTERM; exec " + command + " > /dev/null", directory, {{"TZ", "UTC0"}}},
                 kTimeLimit});
  // As the shell says it; a program that is there may end like that, too.
  if (result.exit_status == kNotFound && result.output.ends_with(": not found\n")) {
    throw Error(program +
                ": not found; install gnuplot (Debian package gnuplot-nox), which draws "
                "the figures");
  }
  if (result.timed_out) {
    throw Error(fmt::format("{}: {} didn't come to its end on {}.gp in {:.0f} s, and was ended",
                            path.string(), program, script.name, kTimeLimit));
  }
  if (result.exit_status != 0) {
    throw Error(fmt::format("{}: {} failed with status {} on {}.gp:\n{}", path.string(), program,
                            result.exit_status, script.name, result.output));
  }
  std::error_code missing;
  if (std::filesystem::file_size(file.temporary(), missing) == 0 || missing) {
    throw Error(fmt::format("{}: {} has drawn nothing from {}.gp; is there space left (df)?{}{}",
                            path.string(), program, script.name, result.output.empty() ? "" : "\n",
                            result.output));
  }
  const std::string drawn = read_text_file(file.temporary());
  if (format == ImageFormat::svg) {
    write_text_file(file.temporary(), with_overlay(tidy_svg(drawn), script.overlay));
  } else if (format == ImageFormat::pdf) {
    write_text_file(file.temporary(), without_date(drawn));
  }
  file.commit();
  return path;
}

}  // namespace

FigureFiles render_script(const GnuplotScript& script, const std::filesystem::path& directory,
                          const std::string& program) {
  check_file_stem("figure", script.name);
  const std::filesystem::path path = directory / (script.name + ".gp");
  write_text_file(path, file_text(script));
  return {path, run(program, script, directory, ImageFormat::svg),
          run(program, script, directory, ImageFormat::png),
          run(program, script, directory, ImageFormat::pdf)};
}

std::string gnuplot_string(std::string_view text) {
  std::string quoted = "'";
  for (const char c : printable(text)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\'') {
      quoted += "’";
    } else {
      quoted += byte < 0x20 || byte == 0x7f ? ' ' : c;
    }
  }
  return quoted + '\'';
}

void write_data_file(const std::filesystem::path& path, std::string_view comment,
                     const RowMatrix& values) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "# {}\n", printable_line(comment));
  for (Index i = 0; i < values.rows(); ++i) {
    for (Index k = 0; k < values.cols(); ++k) {
      const double v = values(i, k);
      fmt::format_to(out, "{}{}", k > 0 ? " " : "", std::isfinite(v) ? fmt::to_string(v) : "NaN");
    }
    text.push_back('\n');
  }
  write_text_file(path, {text.data(), text.size()});
}

}  // namespace npdr::analysis
