#include "core/finding.h"

namespace npdr {

std::vector<std::string> lines_of(const Finding& finding) {
  std::vector<std::string> lines = {finding.what, finding.evidence, finding.advice};
  std::erase(lines, "");
  return lines;
}

std::string text_of(const Finding& finding) {
  const bool warns = finding.severity >= Severity::suspicious;
  return (finding.where.empty() ? "" : finding.where + ": ") + (warns ? "warning: " : "") +
         join(lines_of(finding), ". ");
}

std::vector<std::string> texts_of(const Findings& findings) {
  std::vector<std::string> texts;
  for (const Finding& finding : findings) texts.push_back(text_of(finding));
  return texts;
}

}  // namespace npdr
