#include "core/printable.h"

#include <gtest/gtest.h>

namespace npdr {
namespace {

TEST(Printable, KeepsTextOfAllLanguages) {
  for (const char* text : {"", "plain", "Gelenkträgheit ± 3 µm", "θ̇", "振り子", "🙂", "a\n\tb"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, ReplacesWhatCommandsATerminal) {
  EXPECT_EQ(printable("a\x1b[31mb"), "a\uFFFD[31mb");
  EXPECT_EQ(printable("a\x07\x7f\rb"), "a\uFFFD\uFFFD\uFFFDb");
  EXPECT_EQ(printable("a\u009b31mb"), "a\uFFFD31mb");  // the same of one character
}

TEST(Printable, ReplacesWhatReordersText) {
  EXPECT_EQ(printable("a\u202Eb\u2066c\u200Fd\u2028e"), "a\uFFFDb\uFFFDc\uFFFDd\uFFFDe");
}

TEST(Printable, ReplacesBytesThatArentUtf8) {
  EXPECT_EQ(printable("Gr\xF6\xDF"
                      "e"),
            "Gr\uFFFD\uFFFDe");                                // Latin-1
  EXPECT_EQ(printable("\xC0\xAF"), "\uFFFD\uFFFD");            // overlong
  EXPECT_EQ(printable("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");  // a surrogate
  EXPECT_EQ(printable("\xF5\x80\x80\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(printable("a\xE2\x82"), "a\uFFFD\uFFFD");  // cut
}

TEST(Printable, OfALineBreaksNone) { EXPECT_EQ(printable_line("a\nb\tc"), "a\uFFFDb\uFFFDc"); }

}  // namespace
}  // namespace npdr
