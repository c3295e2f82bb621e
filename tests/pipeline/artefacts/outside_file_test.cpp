// Samples and datasets of other programs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/sources/source.h"
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
  const auto posterior = written_h5(folder_ / "infer.h5", [](h5::File& file) {
    file.set_attribute("schema", kPosteriorSchema.name);
  });
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
  EXPECT_TRUE(says(problem([&] {
                     written("a.h5", {}, {"kg", "m"});
                   }),
                   {"a.h5: dataset 'theta' has 0 labels, but 2 units"}));
  const auto nan = written_h5(folder_ / "nan.h5", [](h5::File& file) {
    file.write("theta", RowMatrix(RowMatrix::Constant(4, 2, std::nan(""))));
  });
  EXPECT_THROW(read(nan), InputError);
  EXPECT_THROW(read_sample_set(nan, "samples", 9), InputError);
  EXPECT_THROW(read(folder_ / "missing.h5"), InputError);
  EXPECT_THROW(read(folder_.file("nan.csv", "mass [kg]\nnan\n")), InputError);
}

class DatasetFiles : public FolderTest {
 protected:
  DatasetCounts import(const std::string& theta, const std::string& x) const {
    return import_dataset(folder_.file("theta.csv", theta), folder_.file("x.csv", x),
                          folder_ / "d.h5");
  }
  // A file of other programs: theta of ones, and labels of both datasets.
  std::filesystem::path foreign(const std::vector<std::string>& theta,
                                const std::vector<std::string>& x) const {
    return written_h5(folder_ / "d.h5", [&](h5::File& file) {
      for (const auto& [name, labels] : {std::pair{"theta", &theta}, {"x", &x}}) {
        file.write(name, RowMatrixF(RowMatrixF::Ones(2, std::ssize(*labels))))
            .set_attribute("labels", *labels);
      }
    });
  }
  // What is said of parameters and features that are asked for.
  std::string problem_of(const std::vector<std::string>& parameters,
                         const std::vector<Channel>& features = {}) const {
    return problem([&] { DatasetFile(folder_ / "d.h5", parameters, features); });
  }
};

TEST_F(DatasetFiles, ImportKeepsNamesAndValues) {
  const DatasetCounts counts = import("b,a [kg]\n1,2\n3,4\n5,6\n", "peak [m]\n0.1\nnan\n0.3\n");
  EXPECT_EQ(counts.num_rows, 3);
  EXPECT_EQ(counts.num_failed, 1);
  const DatasetFile dataset(folder_ / "d.h5", {"a"});
  EXPECT_EQ(dataset.parameters(), (std::vector<Channel>{{"a", "kg"}}));
  EXPECT_EQ(dataset.features(), (std::vector<Channel>{{"peak", "m"}}));
  const std::vector<Index> rows = {0, 2};
  EXPECT_EQ(dataset.theta(rows), (RowMatrix(2, 1) << 2, 6).finished());
  EXPECT_EQ(dataset.x(rows), (RowMatrix(2, 1) << 0.1, 0.3).finished());
  EXPECT_TRUE(std::isnan(dataset.x(std::vector<Index>{1})(0, 0)));
}

TEST_F(DatasetFiles, RowsAreFoundAcrossBlocks) {
  std::string theta = "a\n", x;
  for (int i = 0; i < 10'000; ++i) {
    theta += std::to_string(i) + "\n";
    x += std::to_string(-i) + "," + std::to_string(2 * i) + "\n";
  }
  import(theta, x);
  const DatasetFile dataset(folder_ / "d.h5", {"a"});
  const std::vector<Index> rows = {9999, 4096, 0, 4097, 17, 1, 9000, 4095, 4096, 5};
  const RowMatrix found = dataset.theta(rows);
  const RowMatrix features = dataset.x(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(found(static_cast<Index>(i), 0), static_cast<double>(rows[i]));
    EXPECT_EQ(features(static_cast<Index>(i), 1), 2.0 * static_cast<double>(rows[i]));
  }
}

TEST_F(DatasetFiles, NamesAndUnitsMustBeThere) {
  import("a,b\n1,2\n", "p,q [mm]\n1,2\n");
  EXPECT_TRUE(says(problem_of({"a"}, {{"p", "1"}, {"r", "1"}}),
                   {"d.h5: dataset 'x': has no column 'r'", "it has p, q"}));
  EXPECT_TRUE(says(problem_of({"a"}, {{"q", "m"}, {"p", "1"}}),
                   {"d.h5: dataset 'x': column 'q' is in [mm]", "must be in [m]"}));
  const DatasetFile swapped(folder_ / "d.h5", {"b"}, {{"q", "1"}, {"p", "1"}});
  EXPECT_EQ(swapped.x(std::vector<Index>{0}), (RowMatrix(1, 2) << 2, 1).finished());
}

TEST_F(DatasetFiles, HostileOnesAreRejected) {
  import("a\n1\n", "1\n");
  const std::string whole = text_of(folder_ / "d.h5");
  folder_.file("d.h5", whole.substr(0, whole.size() / 2));
  EXPECT_NE(problem_of({"a"}), "");
  written_h5(folder_ / "d.h5", [](h5::File& file) {
    file.write("theta", RowMatrix(RowMatrix::Ones(3, 1)));
    file.write("x", RowMatrix(RowMatrix::Ones(2, 1)));
  });
  EXPECT_TRUE(says(problem_of({"a"}), {"d.h5: dataset 'x' has shape (2, 1)", "must be (3, any)"}));
}

TEST_F(DatasetFiles, UnitsMayStandInLabels) {
  const auto path = foreign({"a [kg]", "b"}, {"p"});
  EXPECT_EQ(DatasetFile(path, {"b", "a"}).parameters(),
            (std::vector<Channel>{{"b", "1"}, {"a", "kg"}}));
  EXPECT_EQ(DatasetFile(path, {}).parameters(), (std::vector<Channel>{{"a", "kg"}, {"b", "1"}}));
}

TEST_F(DatasetFiles, LabelsMustBeDistinct) {
  for (const auto& [second, said] : {std::pair{"p", "two columns have the label 'p'"},
                                     {"p [mm]", "two columns have the label 'p'"},
                                     {"", "label 2 is empty"}}) {
    foreign({"a"}, {"p", second});
    EXPECT_EQ(problem_of({"a"}), std::string("d.h5: dataset 'x': ") + said);
  }
}

// Each compared with all before it, they would take an hour.
TEST_F(DatasetFiles, AMillionColumnsAreReadInSeconds) {
  std::vector<std::string> labels;
  for (Index c = 0; c < 1'000'000; ++c) labels.push_back("column_" + std::to_string(c));
  EXPECT_EQ(DatasetFile(foreign({"a"}, labels), {"a"}).features().size(), labels.size());
}

TEST(DatasetRows, AreARandomSubsetThatGrows) {
  const std::vector<Index> some = dataset_rows(1, 1000, 100);
  const std::vector<Index> more = dataset_rows(1, 1000, 500);
  EXPECT_TRUE(std::ranges::equal(std::span(more).first(100), some));
  EXPECT_NE(dataset_rows(2, 1000, 100), some);
  // What begins, or ends, the rows of a sorted file is like all of them: a mean of 500 with a
  // standard error of 289 / 10 sqrt(0.9) = 27, of which five are a false alarm in a million.
  std::vector<Index> all = dataset_rows(3, 1000, 1000);
  for (const auto& part : {std::span(all).first(100), std::span(all).last(100)}) {
    EXPECT_NEAR(std::accumulate(part.begin(), part.end(), 0.0) / 100.0, 499.5, 137.0);
  }
  std::ranges::sort(all);
  for (Index i = 0; i < 1000; ++i) EXPECT_EQ(all[static_cast<std::size_t>(i)], i);
}

TEST(DatasetRows, OutsideOfThePriorOrNotFiniteTheyHaveFailed) {
  const inference::Prior prior({{"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0}});
  const RowMatrix theta = (RowMatrix(4, 1) << 0.5, 1.5, 0.5, 1.0).finished();
  const RowMatrix x = (RowMatrix(4, 1) << 1, 2, std::nan(""), 4).finished();
  const sim::Trajectories rows = as_simulated(prior, theta, x);
  using enum sim::RolloutStatus;
  EXPECT_EQ(rows.status, (std::vector{ok, out_of_limits, diverged, ok}));
  EXPECT_TRUE(std::isnan(rows.row(1)[0]));
  EXPECT_EQ(rows.row(3)[0], 4.0f);
}

}  // namespace
}  // namespace npdr::pipeline
