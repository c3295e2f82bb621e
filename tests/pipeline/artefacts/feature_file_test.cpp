#include "pipeline/artefacts/feature_file.h"

#include <cmath>

#include "core/error.h"
#include "core/feature_names.h"
#include "pipeline/store/h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::vector<Channel> kFeatures = {{"peak", "m"}, {"mean", "1"}};

class FeatureFiles : public ::testing::Test {
 protected:
  FeatureRows read(const std::string& text, Index num_rows,
                   const std::vector<Channel>& expected = kFeatures) const {
    return read_features(folder_.file("x.csv", text), FileFormat::csv, num_rows, expected);
  }
  std::string problem_of(const std::string& text, Index num_rows) const {
    return message_of<InputError>([&] { read(text, num_rows); }, &folder_);
  }
  // The same of a file that `fill` has written.
  template <class Fill>
  std::string hdf5_problem(const Fill& fill) const {
    h5::File file = h5::File::create(folder_ / "x.h5");
    fill(file);
    file.close();
    return message_of<InputError>(
        [&] { read_features(folder_ / "x.h5", FileFormat::hdf5, 2, kFeatures); }, &folder_);
  }

  TempFolder folder_;
};

TEST_F(FeatureFiles, NamedColumnsMayBeInAnyOrder) {
  EXPECT_EQ(read("mean,peak\n1,2\n3,4\n", 2).x, (RowMatrix(2, 2) << 2, 1, 4, 3).finished());
  EXPECT_EQ(read("1,2\n3,4\n", 2).x, (RowMatrix(2, 2) << 1, 2, 3, 4).finished());
}

TEST_F(FeatureFiles, NameThemselvesWhereNobodyElseHas) {
  EXPECT_EQ(read("b [s],a\n1,2\n", 1, {}).features, (std::vector<Channel>{{"b", "s"}, {"a", "1"}}));
  EXPECT_EQ(read("1,2\n", 1, {}).features, (std::vector<Channel>{{"x0", "1"}, {"x1", "1"}}));
}

TEST_F(FeatureFiles, WithNamesNeedAnObservationWithNames) {
  const auto problem = [&](const std::string& text) {
    return message_of<InputError>(
        [&] {
          read_features(folder_.file("x.csv", text), FileFormat::csv, 1, numbered_features(2),
                        {.names_from = NamesFrom::nobody});
        },
        &folder_);
  };
  EXPECT_EQ(problem("x1,x0 [m]\n1,2\n"), "");
  EXPECT_EQ(problem("1,2\n"), "");
  EXPECT_TRUE(says(problem("x1,x2\n1,2\n"), {"x.csv: has no column 'x0'", "it has x1, x2"}));
}

TEST_F(FeatureFiles, MustHaveTheRowsAndColumnsThatAreExpected) {
  EXPECT_EQ(problem_of("1,2\n", 2), "x.csv: has 1 row, must have 2");
  EXPECT_TRUE(
      says(problem_of("1,2\n3,4\n5,6\n", 2), {"x.csv: has more than 2 rows", "must have 2"}));
  EXPECT_TRUE(says(problem_of("1\n2\n", 2), {"x.csv: has 1 column", "must have 2"}));
  EXPECT_TRUE(says(problem_of("peak,men\n1,2\n", 1),
                   {"x.csv: has no column 'mean'", "'men'", "it has peak, men"}));
  EXPECT_TRUE(says(problem_of("peak,mean,rest\n1,2,3\n", 1),
                   {"x.csv: has 3 columns", "must have 2", "peak [m], mean"}));
}

TEST_F(FeatureFiles, ThatProgramsWriteMustEndTheirLastLine) {
  const auto read_output = [&](const std::string& text) {
    return read_features(folder_.file("x.csv", text), FileFormat::csv, 2, kFeatures,
                         {.needs_line_ends = true});
  };
  const auto problem = [&](const std::string& text) {
    return message_of<InputError>([&] { read_output(text); }, &folder_);
  };
  EXPECT_EQ(problem("1,2\n3,4000\n"), "");
  EXPECT_EQ(problem("1,2\r\n3,4000\r\n\n"), "");
  EXPECT_EQ(problem("1,2\n3,400"),
            "x.csv: its last line has no end, as if the file were cut; end each line");
  EXPECT_EQ(read("1,2\n3,400", 2).x(1, 1), 400.0);  // what a person wrote
}

TEST_F(FeatureFiles, OfHdf5MustHoldTheDataset) {
  EXPECT_TRUE(
      says(hdf5_problem([](h5::File& file) { file.write("y", RowMatrix(RowMatrix::Zero(2, 2))); }),
           {"x.h5: has no dataset 'x'", "it has y"}));
  EXPECT_TRUE(
      says(hdf5_problem([](h5::File& file) { file.write("x", RowMatrix(RowMatrix::Zero(3, 2))); }),
           {"x.h5: dataset 'x' has shape (3, 2)", "must be (2, any)"}));
  EXPECT_TRUE(
      says(hdf5_problem([](h5::File& file) { file.write("x", RowMatrix(RowMatrix::Zero(2, 3))); }),
           {"x.h5: dataset 'x': has 3 columns", "must have 2"}));
  EXPECT_NE(hdf5_problem([](h5::File& file) { file.write_texts("x", {"a", "b"}); }), "");
}

TEST_F(FeatureFiles, AnObservationIsOneFiniteRow) {
  const Target target = read_observation(folder_.file("x_o.csv", "peak [m],mean\n3,4\n"), {});
  EXPECT_EQ(target.state_channels, kFeatures);
  EXPECT_EQ(target.num_steps(), 1);
  EXPECT_EQ(target.rollouts.front().states.row(1), Eigen::RowVector2d(3, 4));
  target.check("x_o");
  const auto problem = [&](const std::string& text) {
    return message_of<InputError>([&] { read_observation(folder_.file("x_o.csv", text), {}); },
                                  &folder_);
  };
  EXPECT_TRUE(says(problem("a,b\n1,nan\n"),
                   {"x_o.csv: 'b' = nan", "must be a number of magnitude 3.40282e+38"}));
  EXPECT_TRUE(says(problem("1,2\n3,4\n"), {"x_o.csv: has more than 1 row,", "must have 1"}));
  EXPECT_TRUE(says(problem("1e200\n"),
                   {"x_o.csv: 'x0' = 1e+200", "must be a number of magnitude 3.40282e+38"}));
}

TEST_F(FeatureFiles, AnObservationMayBeAVectorOfHdf5) {
  h5::File file = h5::File::create(folder_ / "x_o.h5");
  file.write("x", Vector(Vector::LinSpaced(3, 1.0, 3.0)));
  file.close();
  EXPECT_EQ(read_observation(folder_ / "x_o.h5", {}).rollouts.front().states.row(1),
            Eigen::RowVector3d(1, 2, 3));
}

}  // namespace
}  // namespace npdr::pipeline
