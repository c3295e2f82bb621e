/// Characters beyond ASCII for pdfLaTeX, whose fonts have few of them.
#pragma once

#include <string>
#include <string_view>

namespace npdr::analysis {

/// UTF-8 text with commands in place of the characters beyond ASCII: signs, superscripts, Greek
/// letters. Letters of Latin-1 stay, as LaTeX's own encodings have them; what isn't known becomes
/// "U+4E2D". All without packages.
std::string latex_symbols(std::string_view text);

/// Whether a text from a user is a formula that can stand in any document: letters, digits,
/// ordinary signs, sub- and superscripts, Greek letters, accents and fonts, with braces that are
/// balanced. Nothing in it reads or writes files.
bool is_latex_symbol(std::string_view text);

}  // namespace npdr::analysis
