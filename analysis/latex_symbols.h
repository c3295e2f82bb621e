/// Characters beyond ASCII for pdfLaTeX, whose fonts have few of them.
#pragma once

#include <string>
#include <string_view>

namespace npdr::analysis {

/// UTF-8 text with commands in place of the characters beyond ASCII: signs, superscripts, Greek
/// letters. Letters of Latin-1 stay, as LaTeX's own encodings have them; what isn't known becomes
/// "U+4E2D". All without packages.
std::string latex_symbols(std::string_view text);

}  // namespace npdr::analysis
