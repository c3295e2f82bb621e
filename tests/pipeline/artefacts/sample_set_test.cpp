#include "pipeline/artefacts/sample_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "pipeline/store/h5.h"
#include "tests/pipeline/store/written_h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class SampleSets : public FolderTest {
 protected:
  // Rows (i, 10 i) of mass and length, or in the other order.
  SampleSet written(const std::string& name, const std::vector<std::string>& labels,
                    const std::vector<std::string>& units, Index rows = 4, Index most = 9) const {
    return read(written_h5(folder_ / name,
                           [&](h5::File& file) {
                             RowMatrix values(rows, 2);
                             for (Index i = 0; i < rows; ++i)
                               values.row(i) << double(i), 10.0 * double(i);
                             h5::Dataset dataset = file.write("theta", values);
                             if (!labels.empty()) dataset.set_attribute("labels", labels);
                             if (!units.empty()) dataset.set_attribute("units", units);
                           }),
                most);
  }
  static SampleSet read(const std::filesystem::path& path, Index most = 9) {
    return read_sample_set(path, "theta", most);
  }
  SampleSet named() const { return written("a.h5", {"mass", "length"}, {"kg", "m"}); }
};

// Without names the order counts, without units the names do.
TEST_F(SampleSets, OfHdf5AndCsvAreReadAlike) {
  const SampleSet set = named();
  const std::string rows = "\n0,0\n10,1\n20,2\n30,3\n";
  for (const SampleSet& other :
       {read(folder_.file("a.csv", "length [m],mass [kg]" + rows)), written("b.h5", {}, {}),
        read(folder_.file("b.csv", "length,mass" + rows)),
        read(folder_.file("c.csv", "0,0\n1,10\n2,20\n3,30\n"))}) {
    EXPECT_EQ(in_order_of(set, other).rows, set.rows);
    EXPECT_EQ(in_order_of(other, set).rows, other.rows);
  }
  EXPECT_EQ(read(folder_ / "a.h5", 3).rows.rows(), 3);
}

// Files hold seeds one after the other, and chains in turn.
TEST_F(SampleSets, OfALongFileAllPartsHaveTheirShare) {
  const SampleSet set = written("a.h5", {}, {}, 1000, 100);
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

TEST_F(SampleSets, StudiesAndPosteriorsAreNone) {
  EXPECT_TRUE(says(problem([&] { read(folder_.file("s.toml", "[study]\n")); }),
                   {"s.toml: is a study, must be samples", "npdr sample"}));
  const auto posterior = written_h5(
      folder_ / "infer.h5", [](h5::File& file) { file.set_attribute("schema", "posterior"); });
  EXPECT_TRUE(says(problem([&] { read(posterior); }),
                   {"infer.h5: is a posterior, must be samples: npdr sample "}));
}

TEST_F(SampleSets, OfOtherParametersAreRejected) {
  const SampleSet set = named();
  const auto refusal = [&](const SampleSet& other) {
    return problem([&] { in_order_of(set, other); });
  };
  EXPECT_TRUE(says(refusal(written("b.h5", {"mass", "width"}, {"kg", "m"})),
                   {"b.h5: dataset 'theta': has no column 'length'", "it has mass, width"}));
  EXPECT_TRUE(says(refusal(written("c.h5", {"mass", "length"}, {"g", "m"})),
                   {"c.h5: dataset 'theta': column 'mass' is in [g]", "must be in [kg]"}));
  EXPECT_TRUE(says(refusal(read(folder_.file("d.csv", "mass [kg]\n1\n"))),
                   {"d.csv: 1 columns", "must be 2 as in a.h5", "'theta'"}));
}

TEST_F(SampleSets, ThatAreBrokenAreRejected) {
  EXPECT_TRUE(says(problem([&] { written("a.h5", {"mass"}, {"kg"}); }),
                   {"a.h5: dataset 'theta' has 2 columns", "1 labels"}));
  const auto nan = written_h5(folder_ / "nan.h5", [](h5::File& file) {
    file.write("theta", RowMatrix(RowMatrix::Constant(4, 2, std::nan(""))));
  });
  EXPECT_THROW(read(nan), InputError);
  EXPECT_THROW(read_sample_set(nan, "samples", 9), InputError);
  EXPECT_THROW(read(folder_ / "missing.h5"), InputError);
  EXPECT_THROW(read(folder_.file("nan.csv", "mass [kg]\nnan\n")), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
