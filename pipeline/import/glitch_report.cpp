#include "pipeline/import/glitch_report.h"

#include <fmt/format.h>

#include "pipeline/import/glitches.h"

namespace npdr::pipeline {
namespace {

std::string remedy_of_glitches(const CsvRows& rows, const CsvOptions& options) {
  if (rows.time.empty()) return "put its value right";
  return options.resample ? "leave its row out" : "leave its row out and add --resample DT";
}

}  // namespace

std::vector<std::string> words_of_glitches(const std::vector<CsvRows>& files,
                                           const CsvOptions& options) {
  std::vector<std::string> words;
  for (const CsvRows& rows : files) {
    for (std::size_t c = 0; c < rows.states.size(); ++c) {
      const Vector values = rows.state_values.col(static_cast<Index>(c));
      const std::vector<Index> glitches = find_glitches(values);
      if (glitches.empty()) continue;
      const Index t = glitches.front();
      const std::string others =
          glitches.size() > 1 ? fmt::format(", and {} more", glitches.size() - 1) : "";
      words.push_back(fmt::format(
          "{}:{}: {} = {:.6g} alone, between {:.4g} and {:.4g}{}: a glitch of the sensor? Noise "
          "and errors count as shares of the channel's largest magnitude: {}",
          rows.name, t + 2, rows.states[c].label, values(t), values(t - 1), values(t + 1), others,
          remedy_of_glitches(rows, options)));
    }
  }
  return words;
}

}  // namespace npdr::pipeline
