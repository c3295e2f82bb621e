#include "pipeline/artefacts/dataset_file.h"

#include <cmath>
#include <numeric>

#include "core/error.h"
#include "pipeline/sources/dataset_source.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class DatasetFiles : public ::testing::Test {
 protected:
  DatasetCounts import(const std::string& theta, const std::string& x) const {
    return import_dataset(folder_.file("theta.csv", theta), folder_.file("x.csv", x),
                          folder_ / "d.h5");
  }

  TempFolder folder_;
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

TEST_F(DatasetFiles, NamesMustBeThere) {
  import("a,b\n1,2\n", "p,q\n1,2\n");
  const auto problem = [&](const std::vector<std::string>& parameters,
                           const std::vector<Channel>& features) {
    return message_of<InputError>([&] { DatasetFile(folder_ / "d.h5", parameters, features); },
                                  &folder_);
  };
  EXPECT_TRUE(
      says(problem({"a", "c"}, {}), {"d.h5: dataset 'theta': has no column 'c'", "it has a, b"}));
  EXPECT_TRUE(says(problem({"a"}, {{"p", "1"}, {"r", "1"}}),
                   {"d.h5: dataset 'x': has no column 'r'", "it has p, q"}));
  const DatasetFile swapped(folder_ / "d.h5", {"b"}, {{"q", "1"}, {"p", "1"}});
  EXPECT_EQ(swapped.x(std::vector<Index>{0}), (RowMatrix(1, 2) << 2, 1).finished());
}

TEST_F(DatasetFiles, HostileOnesAreRejected) {
  {
    h5::File file = h5::File::create(folder_ / "bad.h5");
    file.write("theta", RowMatrix(RowMatrix::Ones(3, 1)));
    file.write("x", RowMatrix(RowMatrix::Ones(2, 1)));
    file.close();
  }
  EXPECT_TRUE(
      says(message_of<InputError>([&] { DatasetFile(folder_ / "bad.h5", {"a"}); }, &folder_),
           {"bad.h5: dataset 'x' has shape (2, 1)", "must be (3, any)"}));
  import("a\n1\n", "1\n");
  const std::string whole = text_of(folder_ / "d.h5");
  folder_.file("d.h5", whole.substr(0, whole.size() / 2));
  EXPECT_THROW(DatasetFile(folder_ / "d.h5", {"a"}), InputError);
}

TEST_F(DatasetFiles, UnitsMayStandInLabels) {
  h5::File file = h5::File::create(folder_ / "h5py.h5");
  file.write("theta", RowMatrix(RowMatrix::Ones(3, 2)))
      .set_attribute("labels", std::vector<std::string>{"a [kg]", "b"});
  file.write("x", RowMatrix(RowMatrix::Ones(3, 1)));
  file.close();
  EXPECT_EQ(DatasetFile(folder_ / "h5py.h5", {"b", "a"}).parameters(),
            (std::vector<Channel>{{"b", "1"}, {"a", "kg"}}));
  EXPECT_EQ(DatasetFile(folder_ / "h5py.h5", {}).parameters(),
            (std::vector<Channel>{{"a", "kg"}, {"b", "1"}}));
}

TEST_F(DatasetFiles, LabelsMustBeDistinct) {
  const auto problem = [&](const std::vector<std::string>& labels) {
    h5::File file = h5::File::create(folder_ / "twice.h5");
    file.write("theta", RowMatrix(RowMatrix::Ones(3, 1)))
        .set_attribute("labels", std::vector<std::string>{"a"});
    file.write("x", RowMatrix(RowMatrix::Ones(3, 2))).set_attribute("labels", labels);
    file.close();
    return message_of<InputError>([&] { DatasetFile(folder_ / "twice.h5", {"a"}); }, &folder_);
  };
  EXPECT_EQ(problem({"p", "p"}), "twice.h5: dataset 'x': two columns have the label 'p'");
  EXPECT_EQ(problem({"p [m]", "p [mm]"}), "twice.h5: dataset 'x': two columns have the label 'p'");
  EXPECT_EQ(problem({"p", ""}), "twice.h5: dataset 'x': label 2 is empty");
}

// Each compared with all before it, they would take an hour.
TEST_F(DatasetFiles, AMillionColumnsAreReadInSeconds) {
  constexpr Index count = 1'000'000;
  std::vector<std::string> labels;
  for (Index c = 0; c < count; ++c) labels.push_back("column_" + std::to_string(c));
  h5::File file = h5::File::create(folder_ / "wide.h5");
  file.write("theta", RowMatrix(RowMatrix::Ones(2, 1)))
      .set_attribute("labels", std::vector<std::string>{"a"});
  file.write("x", RowMatrixF(RowMatrixF::Ones(2, count))).set_attribute("labels", labels);
  file.close();
  EXPECT_EQ(std::ssize(DatasetFile(folder_ / "wide.h5", {"a"}).features()), count);
}

TEST_F(DatasetFiles, OtherUnitsAreRejected) {
  import("a\n1\n", "p [mm]\n1\n");
  EXPECT_NO_THROW(DatasetFile(folder_ / "d.h5", {"a"}, {{"p", "1"}}));
  EXPECT_TRUE(says(message_of<InputError>(
                       [&] {
                         DatasetFile(folder_ / "d.h5", {"a"}, {{"p", "m"}});
                       },
                       &folder_),
                   {"d.h5: dataset 'x': column 'p' is in [mm]", "must be in [m]"}));
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
