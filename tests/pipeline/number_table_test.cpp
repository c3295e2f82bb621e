#include "pipeline/store/number_table.h"

#include <cmath>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class NumberTables : public ::testing::Test {
 protected:
  std::vector<std::vector<double>> rows_of(const std::string& text) const {
    NumberTable table(folder_.file("t.csv", text));
    std::vector<std::vector<double>> rows;
    std::vector<double> row(static_cast<std::size_t>(table.num_columns()));
    while (table.next(row)) rows.push_back(row);
    return rows;
  }
  std::string problem_of(const std::string& text) const {
    return message_of<InputError>([&] { rows_of(text); }, &folder_);
  }

  TempFolder folder_;
};

TEST_F(NumberTables, MayHaveAHeader) {
  NumberTable with(folder_.file("a.csv", "\xEF\xBB\xBFpeak [m],\"mean\"\r\n1, 2.5\r\n\r\n"));
  EXPECT_EQ(with.columns(), (std::vector<Channel>{{"peak", "m"}, {"mean", "1"}}));
  NumberTable without(folder_.file("b.csv", "1,+2e-3\n3,4"));
  EXPECT_FALSE(without.has_header());
  EXPECT_EQ(without.num_columns(), 2);
  EXPECT_EQ(rows_of("1,+2e-3\n3,4"), (std::vector<std::vector<double>>{{1, 2e-3}, {3, 4}}));
}

TEST_F(NumberTables, KeepNanAndInfinity) {
  const auto rows = rows_of("x,y\nnan,inf\nNA,-1e999\n1e-999,0\n");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_TRUE(std::isnan(rows[0][0]) && std::isnan(rows[1][0]));
  EXPECT_TRUE(std::isinf(rows[0][1]) && std::isinf(rows[1][1]));
  EXPECT_EQ(rows[2][0], 0.0);
}

TEST_F(NumberTables, SayWhereTheyAreWrong) {
  EXPECT_EQ(problem_of(""), "t.csv: is empty");
  EXPECT_TRUE(says(problem_of("a,b\n1,2\n3\n"),
                   {"t.csv:3: has 1 columns", "must have 2 like the first line"}));
  EXPECT_TRUE(
      says(problem_of("a,b\n1,2\n3,x\n"), {"t.csv:3: column 2 'b' = 'x'", "must be a number"}));
  EXPECT_TRUE(says(problem_of("1,2\n3,\n"), {"t.csv:2: column 2 = ''", "must be a number"}));
  EXPECT_EQ(problem_of("a,a\n1,2\n"), "t.csv:1: column 2 is a second one headed 'a'");
  EXPECT_EQ(problem_of("a,\n1,2\n"), "t.csv:1: column 2 has no name");
  EXPECT_TRUE(says(problem_of("a\n1\n\n2\n"), {"t.csv:3: is empty", "rows follow", "remove it"}));
  EXPECT_EQ(problem_of("a,\"b\n1,2\n"), "t.csv:1: column 2 has no closing quote");
  EXPECT_EQ(message_of<InputError>([&] { NumberTable(folder_ / "none.csv"); }, &folder_),
            "none.csv: isn't there");
  EXPECT_EQ(message_of<InputError>([&] { NumberTable("/dev/zero"); }, &folder_),
            "/dev/zero: isn't a file");
}

}  // namespace
}  // namespace npdr::pipeline
