#include "pipeline/artefacts/feature_file.h"

#include <tuple>

#include "core/feature_names.h"
#include "pipeline/store/h5.h"
#include "tests/pipeline/store/written_h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::vector<Channel> kFeatures = {{"peak", "m"}, {"mean", "1"}};

class FeatureFiles : public FolderTest {
 protected:
  FeatureRows read(const std::string& text, Index num_rows,
                   const std::vector<Channel>& expected = kFeatures) const {
    return read_features(folder_.file("x.csv", text), FileFormat::csv, num_rows,
                         {.features = expected});
  }
  // What is said of a file that `fill` has written.
  template <class Fill>
  std::string hdf5_problem(const Fill& fill) const {
    const auto path = written_h5(folder_ / "x.h5", fill);
    return problem([&] { read_features(path, FileFormat::hdf5, 2, {.features = kFeatures}); });
  }
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
  const auto problem_of = [&](const std::string& text, NamesFrom names_from = NamesFrom::nobody) {
    return problem([&] {
      read_features(folder_.file("x.csv", text), FileFormat::csv, 1,
                    {.features = numbered_features(2), .names_from = names_from});
    });
  };
  EXPECT_EQ(problem_of("x1,x0 [m]\n1,2\n"), "");
  EXPECT_EQ(problem_of("1,2\n"), "");
  EXPECT_TRUE(says(problem_of("x1,x2\n1,2\n"), {"x.csv: has no column 'x0'", "it has x1, x2"}));
  EXPECT_TRUE(says(problem_of("x1,x2\n1,2\n", NamesFrom::study), {"x.csv: has no column 'x0'"}))
      << "the study has named it";
}

TEST_F(FeatureFiles, MustHaveTheRowsAndColumnsThatAreExpected) {
  const std::vector<std::tuple<std::string, Index, std::string>> cases = {
      {"1,2\n", 2, "has 1 row, must have 2"},
      {"1,2\n3,4\n5,6\n", 2, "has more than 2 rows, must have 2"},
      {"1\n2\n", 2, "has 1 column, must have 2"},
      {"peak,men\n1,2\n", 1, "has no column 'mean'"},
      {"peak,mean,rest\n1,2,3\n", 1, "has 3 columns, must have 2: peak [m], mean"}};
  for (const auto& [text, num_rows, said] : cases) {
    EXPECT_TRUE(
        says(problem([&, text = text, n = num_rows] { read(text, n); }), {"x.csv: " + said}));
  }
}

TEST_F(FeatureFiles, ThatProgramsWriteMustEndTheirLastLine) {
  const auto problem_of = [&](const std::string& text) {
    return problem([&] {
      read_features(folder_.file("x.csv", text), FileFormat::csv, 2,
                    {.features = kFeatures, .needs_line_ends = true});
    });
  };
  EXPECT_EQ(problem_of("1,2\n3,4000\n"), "");
  EXPECT_EQ(problem_of("1,2\r\n3,4000\r\n\n"), "");
  EXPECT_EQ(problem_of("1,2\n3,400"),
            "x.csv: its last line has no end, as if the file were cut; end each line");
  EXPECT_EQ(read("1,2\n3,400", 2).x(1, 1), 400.0);  // what a person wrote
}

TEST_F(FeatureFiles, OfHdf5MustHoldTheDataset) {
  const auto zeros = [](const char* name, Index rows, Index columns) {
    return [=](h5::File& file) { file.write(name, RowMatrix(RowMatrix::Zero(rows, columns))); };
  };
  EXPECT_TRUE(says(hdf5_problem(zeros("y", 2, 2)), {"x.h5: has no dataset 'x'", "it has y"}));
  EXPECT_TRUE(says(hdf5_problem(zeros("x", 3, 2)),
                   {"x.h5: dataset 'x' has shape (3, 2)", "must be (2, any)"}));
  EXPECT_TRUE(
      says(hdf5_problem(zeros("x", 2, 3)), {"x.h5: dataset 'x': has 3 columns", "must have 2"}));
  EXPECT_NE(hdf5_problem([](h5::File& file) {
              file.write("x", std::vector<std::string>{"a", "b"});
            }),
            "");
}

TEST_F(FeatureFiles, AnObservationIsOneFiniteRow) {
  const Target target = read_observation(folder_.file("x_o.csv", "peak [m],mean\n3,4\n"), {});
  EXPECT_EQ(target.state_channels, kFeatures);
  EXPECT_EQ(target.num_steps(), 1);
  EXPECT_EQ(target.rollouts.front().states.row(1), Eigen::RowVector2d(3, 4));
  target.check("x_o");
  const std::string must = ", must be a number up to 3.40282e+38: leave out";
  for (const auto& [text, said] :
       {std::pair<std::string, std::string>{"a,b\n1,nan\n", "'b' = nan" + must},
        {"1,2\n3,4\n", "has more than 1 row, must have 1"},
        {"1e200\n", "'x0' = 1e+200" + must}}) {
    const auto path = folder_.file("x_o.csv", text);
    EXPECT_TRUE(says(problem([&] { read_observation(path, {}); }), {"x_o.csv: " + said}));
  }
  const auto hdf5 = written_h5(folder_ / "x_o.h5", [](h5::File& file) {
    file.write("x", Vector(Vector::LinSpaced(3, 1.0, 3.0)));
  });
  EXPECT_EQ(read_observation(hdf5, {}).rollouts.front().states.row(1), Eigen::RowVector3d(1, 2, 3));
}

}  // namespace
}  // namespace npdr::pipeline
