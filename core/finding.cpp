#include "core/finding.h"

namespace npdr {

std::string text_of(const Finding& finding) {
  const bool warns = finding.severity >= Severity::suspicious;
  return (finding.where.empty() ? "" : finding.where + ": ") + (warns ? "warning: " : "") +
         finding.what;
}

std::vector<std::string> texts_of(const Findings& findings) {
  std::vector<std::string> texts;
  for (const Finding& finding : findings) texts.push_back(text_of(finding));
  return texts;
}

}  // namespace npdr
