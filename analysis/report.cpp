#include "analysis/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/escape.h"
#include "analysis/report_script.h"
#include "analysis/report_style.h"
#include "analysis/svg.h"
#include "analysis/table_writers.h"
#include "core/atomic_file.h"
#include "core/text.h"

namespace npdr::analysis {
namespace {

// Blank lines end a paragraph.
std::string paragraphs(const std::string& prose) {
  std::string html, paragraph;
  const auto flush = [&] {
    if (!paragraph.empty()) html += "<p>" + escape_html(paragraph) + "</p>\n";
    paragraph.clear();
  };
  std::size_t begin = 0;
  while (begin <= prose.size()) {
    const std::size_t end = std::min(prose.find('\n', begin), prose.size());
    const std::string line = prose.substr(begin, end - begin);
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      flush();
    } else {
      paragraph += (paragraph.empty() ? "" : "\n") + line;
    }
    begin = end + 1;
  }
  flush();
  return html;
}

std::string head(const Report& report) {
  // Nothing may be loaded and nothing else may run, whatever a text or a figure holds.
  const std::string policy =
      fmt::format("default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src '{}'",
                  kReportScriptHash);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta name=\"color-scheme\" content=\"light dark\"/>\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n",
      policy, escape_html(report.title), kReportStyle);
}

std::string lines_html(const std::string& lines) {
  return replaced_all(escape_html(lines), "\n", "<br/>");
}

// Reasons of several verdicts would push the answers off the first screen.
std::string verdict_html(const ReportVerdict& verdict, bool is_open) {
  const std::string words = lines_html(verdict.words);
  if (verdict.reasons.empty()) return words;
  std::string html =
      fmt::format("<details{}><summary>{}</summary>", is_open ? " open=\"\"" : "", words);
  for (const std::string& reason : verdict.reasons) html += "\n<p>" + lines_html(reason) + "</p>";
  return html + "</details>";
}

std::string verdicts_html(const std::vector<ReportVerdict>& verdicts) {
  if (verdicts.empty()) return "";
  std::string html = "<ul class=\"verdicts\">\n";
  for (const ReportVerdict& verdict : verdicts) {
    html += fmt::format("<li class=\"{}\">{}</li>\n", verdict.holds ? "holds" : "fails",
                        verdict_html(verdict, verdicts.size() == 1));
  }
  return html + "</ul>\n";
}

std::string contents(const Report& report) {
  std::string html = "<nav>\n<ol>\n";
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    html += fmt::format("<li><a href=\"#section-{}\">{}</a></li>\n", i + 1,
                        escape_html(report.sections[i].title));
  }
  if (!report.commands.empty()) html += "<li><a href=\"#commands\">Commands</a></li>\n";
  if (!report.provenance.empty()) html += "<li><a href=\"#provenance\">Provenance</a></li>\n";
  return html + "</ol>\n</nav>\n";
}

std::string drawing_html(const std::filesystem::path& svg, const std::string& prefix,
                         const std::string& caption, const char* kind) {
  return fmt::format("<div class=\"{}\"><div class=\"paper\">{}</div></div>\n", kind,
                     inline_svg(read_text_file(svg), prefix, caption));
}

std::string figure_html(const ReportFigure& figure, const std::string& prefix) {
  std::string drawings =
      drawing_html(figure.svg, prefix, figure.caption, figure.narrow ? "drawing wide" : "drawing");
  if (figure.narrow) {
    drawings += drawing_html(*figure.narrow, prefix + "narrow-", figure.caption, "drawing narrow");
  }
  return fmt::format("<figure class=\"plot\">\n{}<figcaption>{}</figcaption>\n</figure>\n",
                     drawings, escape_html(figure.caption));
}

constexpr const char* kSection = "<section id=\"section-{}\">\n<h2>{}</h2>\n{}</section>\n";
constexpr const char* kFoldedSection =
    "<section id=\"section-{}\">\n<details>\n<summary><h2>{}</h2></summary>\n{}</details>\n"
    "</section>\n";

std::string code_html(const std::string& code) {
  if (code.empty()) return "";
  return "<pre tabindex=\"0\"><code>" + escape_html(code) + "</code></pre>\n";
}

std::string section_html(const ReportSection& section, std::size_t number) {
  std::string tables, figures;
  for (const Table& table : section.tables) tables += to_html(table);
  for (std::size_t k = 0; k < section.figures.size(); ++k) {
    figures += figure_html(section.figures[k], fmt::format("figure-{}-{}-", number, k + 1));
  }
  tables += paragraphs(section.remarks);
  const std::string body = paragraphs(section.prose) +
                           (section.figures_first ? figures + tables : tables + figures) +
                           code_html(section.code);
  const std::string title = escape_html(section.title);
  return fmt::format(fmt::runtime(section.is_folded ? kFoldedSection : kSection), number, title,
                     body);
}

std::string commands_html(const std::vector<std::string>& commands) {
  if (commands.empty()) return "";
  return fmt::format("<section id=\"commands\">\n<h2>Commands</h2>\n{}</section>\n",
                     code_html(fmt::format("{}\n", fmt::join(commands, "\n"))));
}

std::string provenance_html(const std::vector<std::pair<std::string, std::string>>& facts) {
  if (facts.empty()) return "";
  std::string html = "<section id=\"provenance\">\n<h2>Provenance</h2>\n<dl>\n";
  for (const auto& [what, value] : facts) {
    html += "<dt>" + escape_html(what) + "</dt><dd>" + escape_html(value) + "</dd>\n";
  }
  return html + "</dl>\n</section>\n";
}

}  // namespace

std::string to_html(const Report& report) {
  std::string html = head(report) + "<body>\n<header>\n<h1>" + escape_html(report.title) +
                     "</h1>\n" + verdicts_html(report.verdicts) + paragraphs(report.prose) +
                     "</header>\n" + contents(report) + "<main>\n";
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    html += section_html(report.sections[i], i + 1);
  }
  html += commands_html(report.commands) + provenance_html(report.provenance);
  return html + "</main>\n<script>" + kReportScript + "</script>\n</body>\n</html>\n";
}

void write_report(const Report& report, const std::filesystem::path& path) {
  write_text_file(path, to_html(report));
}

}  // namespace npdr::analysis
