#include "analysis/escape.h"

#include <gtest/gtest.h>

namespace npdr::analysis {
namespace {

// Other cases are in tests/golden/text.txt.
TEST(Escape, NoneLetsThroughWhatIsntPrintable) {
  for (const auto& escape : {escape_html, escape_markdown, quote_csv}) {
    EXPECT_EQ(escape("a\x1b\xF6\u202Eb"), "a\uFFFD\uFFFD\uFFFDb");
  }
  EXPECT_EQ(escape_latex("a\x1b\xF6\u202Eb"), "a???b");
}

}  // namespace
}  // namespace npdr::analysis
