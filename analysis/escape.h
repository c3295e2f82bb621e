/// Text from people and studies, made safe for the languages that tables and reports are written
/// in. What isn't printable (core/printable.h) is replaced in all of them.
#pragma once

#include <string>
#include <string_view>

namespace npdr::analysis {

/// Safe between tags and in quoted attributes of HTML and SVG.
std::string escape_html(std::string_view text);

/// Stands for itself in a cell of a Markdown table; line breaks become blanks.
std::string escape_markdown(std::string_view text);

/// Stands for itself in LaTeX's text mode; line breaks become blanks.
std::string escape_latex(std::string_view text);

/// A field of a CSV file: quoted when RFC 4180 asks for it. Text that begins with one of = + - @,
/// which spreadsheets take for a formula and compute, begins with an apostrophe instead, unless it
/// is a number.
std::string quote_csv(std::string_view text);

}  // namespace npdr::analysis
