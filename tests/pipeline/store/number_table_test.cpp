
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/feature_names.h"
#include "pipeline/store/number_table.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

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

class NumberTables : public FolderTest {
 protected:
  std::vector<std::vector<double>> rows_of(const std::string& text,
                                           const std::optional<CsvFormat>& format = {}) const {
    const auto path = folder_.file("t.csv", text);
    NumberTable table = format ? NumberTable(path, Header::optional, *format) : NumberTable(path);
    std::vector<std::vector<double>> rows;
    std::vector<double> row(static_cast<std::size_t>(table.num_columns()));
    while (table.next(row)) rows.push_back(row);
    return rows;
  }
  std::string problem_of(const std::string& text,
                         const std::optional<CsvFormat>& format = {}) const {
    return problem([&] { rows_of(text, format); });
  }
};

TEST_F(NumberTables, MayHaveAHeader) {
  NumberTable with(folder_.file("a.csv", "\xEF\xBB\xBFpeak [m],\"mean\"\r\n1, 2.5\r\n\r\n"));
  EXPECT_EQ(with.columns(), (std::vector<Channel>{{"peak", "m"}, {"mean", "1"}}));
  NumberTable of_numpy(folder_.file("n.csv", "# peak [m],mean\n1,2.5\n"));
  EXPECT_EQ(of_numpy.columns(), with.columns());
  NumberTable of_hash(folder_.file("h.csv", "#,#hits\n1,2.5\n"));
  EXPECT_EQ(of_hash.columns().front().label, "#");
  NumberTable without(folder_.file("b.csv", "1,+2e-3\n3,4"));
  EXPECT_FALSE(without.has_header());
  EXPECT_EQ(without.num_columns(), 2);
  EXPECT_EQ(rows_of("1,+2e-3\n3,4"), (std::vector<std::vector<double>>{{1, 2e-3}, {3, 4}}));
}

// Heads on which readers of recordings, datasets and options once disagreed.
TEST_F(NumberTables, AUnitIsTheLastBracketsAfterABlank) {
  const std::vector<std::pair<std::string, Channel>> heads = {
      {"x[0] [m]", {"x[0]", "m"}},        {"x[0]", {"x[0]", ""}},
      {"theta[rad]", {"theta[rad]", ""}}, {"a [b] [ m/s ]", {"a [b]", "m/s"}},
      {"a [b] c", {"a [b] c", ""}},       {"a [", {"a [", ""}},
      {"gain []", {"gain", ""}},          {"[m]", {"[m]", ""}}};
  for (auto [head, channel] : heads) {
    EXPECT_EQ(parse_channel(head), channel) << head;
    const std::string name = folder_.file("h.csv", head + "\n1\n");
    if (!channel.unit.empty()) {
      EXPECT_EQ(NumberTable(name, Header::with_units).columns().front(), channel) << head;
    } else {
      EXPECT_THROW(NumberTable(name, Header::with_units), InputError) << head;
      channel.unit = "1";
    }
    EXPECT_EQ(NumberTable(name).columns().front(), channel) << head;
    EXPECT_EQ(parse_feature(head), channel) << head;
  }
}

TEST_F(NumberTables, FieldsThatArentNeededMayHoldAnything) {
  NumberTable table(folder_.file("t.csv", "a,note\n1,fine\n2,\nNA,-\n"));
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.finite_number(0), 1.0);
  EXPECT_FALSE(table.is_missing(1)) << "a word isn't a number, but something";
  ASSERT_TRUE(table.next());
  EXPECT_TRUE(table.is_missing(1));
  ASSERT_TRUE(table.next());
  EXPECT_TRUE(table.is_missing(0));
  EXPECT_EQ(problem([&] { table.finite_number(0); }),
            "t.csv:4: column 1 'a' = 'NA', must be a finite number");
  EXPECT_FALSE(table.next());
}

TEST_F(NumberTables, KeepNanAndInfinity) {
  const auto rows = rows_of("x,y\nnan,inf\nNA,-1e999\n1e-999,0\n");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_TRUE(std::isnan(rows[0][0]) && std::isnan(rows[1][0]));
  EXPECT_TRUE(std::isinf(rows[0][1]) && std::isinf(rows[1][1]));
  EXPECT_EQ(rows[2][0], 0.0);
}

TEST_F(NumberTables, MayBeSeparatedOtherwise) {
  const std::vector<std::vector<double>> expected = {{1.5, -2e-3}, {3, 4}};
  EXPECT_EQ(rows_of("a [m];b\n1,5;-2e-3\n3;4\n", CsvFormat{';', true}), expected);
  EXPECT_EQ(rows_of("1,5;-0,002\n3;4", CsvFormat{';', true}), expected);
  EXPECT_EQ(rows_of("1.5\t-0.002\n3\t4", CsvFormat{'\t', false}), expected);
  EXPECT_TRUE(says(problem_of("a;b\n1.234,5;2\n", CsvFormat{';', true}),
                   {"t.csv:2: column 1 'a' = '1.234,5'", "must be a number"}));
  EXPECT_TRUE(says(problem_of("a;b\n1,5;2\n", CsvFormat{';', false}),
                   {"t.csv:2: column 1 'a' = '1,5'", "must be a number", "--decimal-comma"}));
  EXPECT_EQ(problem_of("a;b\n1,5;2\n"),
            "t.csv:2: has 2 columns, must have 1 like the first line; columns are separated by ','")
      << "who has no choice gets no option";
}

TEST_F(NumberTables, HeadersAreMadePrintable) {
  const std::vector<std::pair<std::string, std::vector<Channel>>> heads = {
      {"a\xC2\xA0[m],\xE2\x80\x8B"
       "b,c \xEF\xBB\xBF",
       {{"a", "m"}, {"b", "1"}, {"c", "1"}}},
      {"Gr\xF6\xDF"
       "e [m],a\x1b[1m,x",
       {{"Gr\uFFFD\uFFFDe", "m"}, {"a\uFFFD[1m", "1"}, {"x", "1"}}}};
  for (const auto& [head, columns] : heads) {
    EXPECT_EQ(NumberTable(folder_.file("t.csv", head + "\n1,2,3\n")).columns(), columns);
  }
}

// Other problems are among those of recordings and datasets: tests/golden/import.txt.
TEST_F(NumberTables, SayWhereTheyAreWrong) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"a,b\n1,2\n3,x\n", "t.csv:3: column 2 'b' = 'x', must be a number"},
      {"1,2\n3,+-4\n", "t.csv:2: column 2 = '+-4', must be a number"},
      {"1,2\n3,\n", "t.csv:2: column 2 = '', must be a number"},
      {"a,\n1,2\n", "t.csv:1: column 2 has no name"},
      {",a\n0,2\n",
       "t.csv:1: column 1 has no name; leave out what only counts rows (pandas: index=False)"},
      {"a,b\n1,\n", "t.csv:2: column 2 'b' = '', must be a number; pandas leaves nan empty"},
      {"a\n1\n\n2\n", "t.csv:3: is empty, but rows follow; remove it"},
      {std::string("\xFF\xFEt\0,\0", 6), "t.csv: holds zero bytes"},
      {"a,b\r1,2\r", "t.csv: has a carriage return (CR) within a line"}};
  for (const auto& [text, said] : cases) EXPECT_TRUE(says(problem_of(text), {said})) << text;
  for (const auto& [path, said] :
       {std::pair{"/dev/zero", "isn't a file"}, {"/proc/self/mem", "reading failed"}}) {
    EXPECT_EQ(problem([&] { NumberTable(std::filesystem::path(path)); }),
              std::string(path) + ": " + said);
  }
}

TEST_F(NumberTables, DontReadAnEndlessLine) {
  const auto path = folder_.file("t.csv", "a\n");
  std::filesystem::resize_file(path, std::uintmax_t{1} << 30);
  EXPECT_TRUE(says(problem([&] { NumberTable(path).next(); }),
                   {"t.csv:1: is followed by one of more than 64 MiB"}));
}

TEST_F(NumberTables, SayWhetherTheLastLineEnds) {
  const auto has_line_end = [&](const std::string& text) {
    NumberTable table(folder_.file("t.csv", text));
    std::vector<double> row(1);
    while (table.next(row)) {
    }
    return table.has_line_end();
  };
  EXPECT_TRUE(has_line_end("1\n2\n"));
  EXPECT_TRUE(has_line_end("1\r\n2\r\n\n"));
  EXPECT_FALSE(has_line_end("1\n2"));
}

}  // namespace
}  // namespace npdr::pipeline
