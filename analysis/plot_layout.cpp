#include "analysis/plot_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/gnuplot.h"

namespace npdr::analysis {
namespace {

constexpr double kMarkWidth = 22.0;  // [px]
constexpr double kMarkGap = 6.0;     // [px] between mark and words

bool begins_character(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
}  // in UTF-8

// Gnuplot's number of a filled mark.
int point_type(LegendMark mark) {
  switch (mark) {
    case LegendMark::triangle:
      return 9;
    case LegendMark::diamond:
      return 13;
    case LegendMark::square:
      return 5;
    default:
      return 7;
  }
}

}  // namespace

std::string translucent(std::string_view color, double opacity) {
  const int transparency = static_cast<int>(std::lround(255.0 * (1.0 - opacity)));
  return fmt::format("'#{:02x}{}'", transparency, color.substr(1));
}

std::string PlotLayout::at(double x, double y) const {
  return fmt::format("screen {:.5f}, screen {:.5f}", x / width_, 1.0 - y / height_);
}

std::string PlotLayout::margins(const Panel& panel) const {
  return fmt::format(
      "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
      "set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n",
      panel.left / width_, (panel.left + panel.width) / width_, 1.0 - panel.top / height_,
      1.0 - (panel.top + panel.height) / height_);
}

std::string PlotLayout::text(double x, double y, std::string_view words,
                             std::string_view options) const {
  return fmt::format("set label {} at {} {}\n", gnuplot_string(words), at(x, y), options);
}

double text_width(std::string_view words, double font_size) {
  const auto characters = std::count_if(words.begin(), words.end(), begins_character);
  return 0.6 * font_size * static_cast<double>(characters);
}

std::string mark_command(LegendMark mark, const std::string& position, double size,
                         std::string_view color) {
  const int type = point_type(mark);
  const auto point = [&](double point_size, std::string_view point_color) {
    return fmt::format("set label '' at {} point pt {} ps {} lc rgb '{}' front\n", position, type,
                       point_size, point_color);
  };
  return point(1.5 * size, "#ffffff") + point(size, color);
}

double legend_entry_width(const LegendEntry& entry, double font_size) {
  return kMarkWidth + kMarkGap + text_width(entry.words, font_size);
}

std::string legend_commands(const PlotLayout& layout, const LegendEntry& entry, double x, double y,
                            double font_size) {
  const std::string line = fmt::format("set arrow from {} to {} nohead lw 2 lc rgb '{}'\n",
                                       layout.at(x, y), layout.at(x + kMarkWidth, y), entry.color);
  std::string commands;
  if (entry.mark == LegendMark::band) {
    commands = fmt::format(
        "set object rectangle from {} to {} fillcolor rgb {} fillstyle solid noborder\n",
        layout.at(x, y + 5.0), layout.at(x + kMarkWidth, y - 5.0), translucent(entry.color, 0.25));
  }
  if (entry.mark == LegendMark::band || entry.mark == LegendMark::line) {
    commands += line;
  } else {
    commands += mark_command(entry.mark, layout.at(x + 0.5 * kMarkWidth, y), 0.8, entry.color);
  }
  return commands + layout.text(x + kMarkWidth + kMarkGap, y, entry.words,
                                fmt::format("left font ',{}'", font_size));
}

std::vector<std::string> wrap_text(std::string_view words, double max_width, double font_size) {
  std::vector<std::string> lines(1);
  std::string word;
  const auto flush = [&] {
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || text_width(longer, font_size) <= max_width) {
      lines.back() = longer;
    } else {
      lines.push_back(word);
    }
    word.clear();
  };
  for (const char c : words) {
    if (c != ' ' && c != '_') {
      word += c;
    } else if (!word.empty()) {
      flush();
    }
  }
  if (!word.empty()) flush();
  return lines;
}

std::string elide_text(std::string_view words, double max_width, double font_size) {
  std::size_t head = words.size() / 2, tail = head;
  const auto elided = [&] {
    return std::string(words.substr(0, head)) + "…" + std::string(words.substr(tail));
  };
  if (text_width(words, font_size) <= max_width) return std::string(words);
  while (head > 0 && tail < words.size() && text_width(elided(), font_size) > max_width) {
    do {
      --head;
    } while (head > 0 && !begins_character(words[head]));
    do {
      ++tail;
    } while (tail < words.size() && !begins_character(words[tail]));
  }
  return elided();
}

}  // namespace npdr::analysis
