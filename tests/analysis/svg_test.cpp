#include "analysis/svg.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace npdr::analysis {
namespace {

TEST(Svg, TidyingGathersRunsOfEqualCircles) {
  EXPECT_EQ(tidy_svg("<g>\n"
                     "\t<use xlink:href='#gpPt6' transform='translate(1.5,2) scale(0.7)' "
                     "color='rgb(1, 2, 3)' opacity='0.55'/>\n"
                     "\t<use xlink:href='#gpPt6' transform='translate(3,4) scale(0.7)' "
                     "color='rgb(1, 2, 3)' opacity='0.55'/>\n"
                     "\t<use xlink:href='#gpPt6' transform='translate(5,6) scale(0.8)' "
                     "color='rgb(9, 9, 9)'/>\n"
                     "</g>\n"),
            "<g>\n"
            "<g fill='rgb(1, 2, 3)' fill-opacity='0.55' stroke='none'>\n"
            "<circle cx='1.5' cy='2' r='0.7'/>\n"
            "<circle cx='3' cy='4' r='0.7'/>\n"
            "</g>\n"
            "<g fill='rgb(9, 9, 9)' fill-opacity='1' stroke='none'>\n"
            "<circle cx='5' cy='6' r='0.8'/>\n"
            "</g>\n"
            "</g>\n");
}

TEST(Svg, TidyingLeavesOtherPointsAndOddLinesAlone) {
  const std::string other =
      "\t<use xlink:href='#gpPt5' transform='translate(1,2) scale(1)' color='x'/>\n"
      "\t<use xlink:href='#gpPt6' transform='translate(1,2) scale(1)' color='x' more='y'/>\n"
      "\t<use xlink:href='#gpPt6' transform='translate(1,2) scale(1)' color='x' opacity=''/>\n"
      "\t<use xlink:href='#gpPt6' transform='translate(1,2)\n";
  EXPECT_EQ(tidy_svg(other), other);
}

TEST(Svg, TidyingEndsAnOpenGroupAtTheEnd) {
  EXPECT_EQ(
      tidy_svg("\t<use xlink:href='#gpPt6' transform='translate(1,2) scale(3)' color='red'/>"),
      "<g fill='red' fill-opacity='1' stroke='none'>\n<circle cx='1' cy='2' r='3'/>\n</g>\n");
}

TEST(Svg, TidyingRemovesTitlesDescriptionsAndEndsOfRawText) {
  EXPECT_EQ(
      tidy_svg("<svg>\n<title>Gnuplot</title>\n<desc>made\nby</desc><title>2</title></svg>\n"),
      "<svg>\n\n</svg>\n");
  EXPECT_EQ(tidy_svg("<text>a]]>b</text>\n"), "<text>a]]&gt;b</text>\n");
}

TEST(Svg, InliningMakesIdsTheFiguresOwn) {
  EXPECT_EQ(inline_svg("<?xml version='1.0'?>\n<svg width='1'><path id='a'/><g id=\"b\"/>"
                       "<use xlink:href='#a'/><use href=\"#b\"/><g clip-path=\"url(#a)\"/></svg>",
                       "f1-", "A \"plot\" & more"),
            "<svg role=\"img\" aria-label=\"A &quot;plot&quot; &amp; more\" width='1'>"
            "<path id='f1-a'/><g id=\"f1-b\"/><use xlink:href='#f1-a'/><use href=\"#f1-b\"/>"
            "<g clip-path=\"url(#f1-a)\"/></svg>");
}

TEST(Svg, InliningRejectsWhatIsNoSvg) {
  EXPECT_THROW(inline_svg("<html></html>", "f", "label"), InputError);
}

}  // namespace
}  // namespace npdr::analysis
