#include "pipeline/artefacts/sample_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "pipeline/store/h5.h"
#include "tests/message_of.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class SampleSets : public ::testing::Test {
 protected:
  // Rows (i, 10 i) of mass and length, or in the other order.
  std::filesystem::path write(const std::string& name, const std::vector<std::string>& labels,
                              const std::vector<std::string>& units, Index rows = 4) {
    h5::File file = h5::File::create(folder_ / name);
    RowMatrix values(rows, 2);
    for (Index i = 0; i < rows; ++i) values.row(i) << double(i), 10.0 * double(i);
    h5::Dataset dataset = file.write("theta", values);
    if (!labels.empty()) dataset.set_attribute("labels", labels);
    if (!units.empty()) dataset.set_attribute("units", units);
    file.close();
    return folder_ / name;
  }
  std::string message(const std::function<void()>& body) const {
    return message_of<InputError>(body, &folder_);
  }

  TempFolder folder_;
};

TEST_F(SampleSets, OfHdf5AndCsvAreReadAlike) {
  const SampleSet set = read_sample_set(write("a.h5", {"mass", "length"}, {"kg", "m"}), "theta", 3);
  const SampleSet csv = read_sample_set(
      folder_.file("a.csv", "length [m],mass [kg]\n0,0\n10,1\n20,2\n30,3\n"), "theta", 3);
  EXPECT_EQ(set.rows.rows(), 3);
  EXPECT_EQ(in_order_of(set, csv).rows, set.rows);
  EXPECT_EQ(in_order_of(csv, set).rows, csv.rows);
}

// Files hold seeds one after the other, and chains in turn.
TEST_F(SampleSets, OfALongFileAllPartsHaveTheirShare) {
  const SampleSet set = read_sample_set(write("a.h5", {}, {}, 1000), "theta", 100);
  std::array<int, 10> in_turn = {};
  for (Index i = 0; i < 100; ++i) {
    const auto row = static_cast<Index>(set.rows(i, 0));
    EXPECT_EQ(row / 10, i);
    ++in_turn[static_cast<std::size_t>(row % 10)];
  }
  // 10 each in expectation; none of 10 is missed but with probability 10 (1 - 1 / 10)^100 = 3e-4.
  EXPECT_GT(*std::ranges::min_element(in_turn), 0);
  std::string text;
  for (int i = 0; i < 1000; ++i) text += fmt::format("{},{}\n", i, 10 * i);
  EXPECT_EQ(read_sample_set(folder_.file("a.csv", text), "", 100).rows, set.rows);
}

TEST_F(SampleSets, AStudyIsNone) {
  const std::string message = message_of<InputError>(
      [&] { read_sample_set(folder_.file("s.toml", "[study]\n"), "theta", 3); }, &folder_);
  EXPECT_TRUE(says(message, {"s.toml: is a study, must be samples", "npdr sample"}));
}

TEST_F(SampleSets, APosteriorIsNone) {
  h5::File file = h5::File::create(folder_ / "infer.h5");
  file.set_attribute("schema", "posterior");
  file.close();
  const std::string message =
      message_of<InputError>([&] { read_sample_set(folder_ / "infer.h5", "theta", 3); }, &folder_);
  EXPECT_TRUE(says(message, {"infer.h5: is a posterior, must be samples: npdr sample "}));
}

TEST_F(SampleSets, WithoutNamesTheOrderCounts) {
  const SampleSet named =
      read_sample_set(write("a.h5", {"mass", "length"}, {"kg", "m"}), "theta", 9);
  const SampleSet plain = read_sample_set(write("b.h5", {}, {}), "theta", 9);
  EXPECT_EQ(in_order_of(named, plain).rows, named.rows);
  const SampleSet csv = read_sample_set(folder_.file("c.csv", "0,0\n1,10\n2,20\n3,30\n"), "", 9);
  EXPECT_EQ(in_order_of(named, csv).rows, named.rows);
}

TEST_F(SampleSets, WithoutUnitsTheNamesCount) {
  const SampleSet named =
      read_sample_set(write("a.h5", {"mass", "length"}, {"kg", "m"}), "theta", 9);
  const SampleSet plain =
      read_sample_set(folder_.file("b.csv", "length,mass\n0,0\n10,1\n20,2\n30,3\n"), "", 9);
  EXPECT_EQ(in_order_of(named, plain).rows, named.rows);
}

TEST_F(SampleSets, OfOtherParametersAreRejected) {
  const auto read = [](const std::filesystem::path& path) {
    return read_sample_set(path, "theta", 9);
  };
  const SampleSet set = read(write("a.h5", {"mass", "length"}, {"kg", "m"}));
  const SampleSet other = read(write("b.h5", {"mass", "width"}, {"kg", "m"}));
  const SampleSet grams = read(write("c.h5", {"mass", "length"}, {"g", "m"}));
  EXPECT_TRUE(says(message([&] { in_order_of(set, other); }),
                   {"b.h5: dataset 'theta': has no column 'length'", "it has mass, width"}));
  EXPECT_TRUE(says(message([&] { in_order_of(set, grams); }),
                   {"c.h5: dataset 'theta': column 'mass' is in [g]", "must be in [kg]"}));
  const SampleSet one = read(folder_.file("d.csv", "mass [kg]\n1\n"));
  EXPECT_TRUE(says(message([&] { in_order_of(set, one); }),
                   {"d.csv: 1 columns", "must be 2 as in a.h5", "'theta'"}));
}

TEST_F(SampleSets, ThatAreBrokenAreRejected) {
  write("a.h5", {"mass"}, {"kg"});
  EXPECT_TRUE(says(message([&] { read_sample_set(folder_ / "a.h5", "theta", 9); }),
                   {"a.h5: dataset 'theta' has 2 columns", "1 labels"}));
  h5::File file = h5::File::create(folder_ / "nan.h5");
  file.write("theta", RowMatrix(RowMatrix::Constant(4, 2, std::nan(""))));
  file.close();
  EXPECT_THROW(read_sample_set(folder_ / "nan.h5", "theta", 9), InputError);
  EXPECT_THROW(read_sample_set(folder_ / "nan.h5", "samples", 9), InputError);
  EXPECT_THROW(read_sample_set(folder_ / "missing.h5", "theta", 9), InputError);
  folder_.file("nan.csv", "mass [kg]\nnan\n");
  EXPECT_THROW(read_sample_set(folder_ / "nan.csv", "theta", 9), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
