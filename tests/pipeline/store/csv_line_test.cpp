#include "pipeline/store/csv_line.h"

#include <gtest/gtest.h>
#include <string>
#include <tuple>
#include <vector>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

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
    EXPECT_THROW(parse_csv_format(other, false), InputError) << other;
  }
  EXPECT_THROW(parse_csv_format(",", true), InputError);
}

TEST(CsvFormats, AreRecognizedByTheirLines) {
  const CsvFormat commas, semicolons = {';', false}, european = {';', true};
  const std::vector<std::tuple<std::string, CsvFormat, std::string>> cases = {
      {"1,5;2,5", commas,
       "; its columns look separated by ';', its decimals look written with a comma: add "
       "--delimiter ';' --decimal-comma"},
      {"a [m]\tb [m]\n1.5\t2.5", commas,
       "; its columns look separated by tabs: add --delimiter tab"},
      {"1,5;2", semicolons, "; its decimals look written with a comma: add --decimal-comma"},
      {"1.5,2", semicolons, "; its columns look separated by commas: leave out --delimiter"},
      {"1.5;2", european, "; its decimals look written with a point: leave out --decimal-comma"},
      {"1,5", commas, ""},
      {"1.5,two", commas, ""},
      {"1.5;two", semicolons, ""},
      {"1,5;two", european, ""}};
  for (const auto& [line, format, hint] : cases) EXPECT_EQ(format_hint(line, format), hint);
}

}  // namespace
}  // namespace npdr::pipeline
