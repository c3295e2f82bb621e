/// The words of findings.
#pragma once

#include "core/finding.h"
#include "core/text.h"

namespace npdr {

/// What they say, without "warning: "; "": there are none.
inline std::string words_of(const Findings& findings) {
  std::vector<std::string> words;
  for (const Finding& finding : findings) words.push_back(join(lines_of(finding), ". "));
  return join(words, "\n");
}

}  // namespace npdr
