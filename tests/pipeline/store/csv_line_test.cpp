#include "pipeline/store/csv_line.h"

#include "core/error.h"
#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

std::string rejected(const std::string& delimiter, bool decimal_comma) {
  return message_of<InputError>([&] { parse_csv_format(delimiter, decimal_comma); });
}

TEST(CsvLine, TheDelimiterSeparatesOutsideOfQuotes) {
  EXPECT_EQ(csv_fields("1,5; \"a;b\" ;2", "x", ';'), (std::vector<std::string>{"1,5", "a;b", "2"}));
  EXPECT_EQ(csv_fields("1\t\t2", "x", '\t'), (std::vector<std::string>{"1", "", "2"}));
}

TEST(CsvFormats, AreACommaASemicolonABarOrATabulator) {
  EXPECT_EQ(parse_csv_format(";", true).delimiter, ';');
  EXPECT_TRUE(parse_csv_format(";", true).decimal_comma);
  EXPECT_EQ(parse_csv_format("tab", false).delimiter, '\t');
  EXPECT_EQ(parse_csv_format("\t", false).delimiter, '\t');
  for (const char* other : {"", " ", ";;", "x"}) {
    EXPECT_TRUE(says(rejected(other, false), {"--delimiter = '", "must be ',', ';', '|' or tab"}));
  }
  EXPECT_TRUE(says(rejected(",", true), {"--decimal-comma", "separate", "--delimiter ';'"}));
}

TEST(CsvFormats, AreRecognizedByTheirLines) {
  const CsvFormat commas, semicolons = {';', false}, european = {';', true};
  EXPECT_EQ(format_hint("1,5;2,5", commas),
            "; its columns look separated by ';', its decimals look written with a comma: add "
            "--delimiter ';' --decimal-comma");
  EXPECT_EQ(format_hint("a [m]\tb [m]\n1.5\t2.5", commas),
            "; its columns look separated by tabs: add --delimiter tab");
  EXPECT_EQ(format_hint("1,5;2", semicolons),
            "; its decimals look written with a comma: add --decimal-comma");
  EXPECT_EQ(format_hint("1.5,2", semicolons),
            "; its columns look separated by commas: leave out --delimiter");
  EXPECT_EQ(format_hint("1.5;2", european),
            "; its decimals look written with a point: leave out --decimal-comma");
}

TEST(CsvFormats, GiveNoHintWithoutASign) {
  EXPECT_EQ(format_hint("1,5", {}), "");
  EXPECT_EQ(format_hint("1.5,two", {}), "");
  EXPECT_EQ(format_hint("1.5;two", {';', false}), "");
  EXPECT_EQ(format_hint("1,5;two", {';', true}), "");
}

}  // namespace
}  // namespace npdr::pipeline
