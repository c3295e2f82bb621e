#include "pipeline/store/h5.h"

#include <array>
#include <functional>
#include <numeric>

#include "core/constants.h"
#include "tests/pipeline/store/written_h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using h5::ElementType;
using h5::File;

class H5Layout : public ::testing::TestWithParam<h5::Storage> {};

TEST_P(H5Layout, RowsCanBeWrittenAndReadInAnyBlocks) {
  const TempFolder folder;
  const h5::Shape shape = {10, 3, 4, 2000};  // two rows a chunk
  std::vector<float> values(240'000);
  std::iota(values.begin(), values.end(), 0.0f);
  File file = File::create(folder / "a.h5");
  h5::Dataset dataset = file.create_dataset("x", ElementType::f32, shape, GetParam());
  EXPECT_EQ(dataset.row_size(), 24'000);
  for (const Index begin : {7, 0, 3}) {
    const Index count = begin == 3 ? 4 : 3;
    dataset.write_rows<float>(begin, count,
                              std::span(values).subspan(begin * 24'000, count * 24'000));
  }
  file.close();

  const File read = File::open(folder / "a.h5");
  const h5::Dataset stored = read.dataset("x");
  EXPECT_EQ(stored.shape(), shape);
  EXPECT_EQ(stored.read<float>(), values);
  std::vector<float> rows(48'000);
  stored.read_rows<float>(5, 2, rows);
  EXPECT_TRUE(std::equal(rows.begin(), rows.end(), values.begin() + 120'000));
}

INSTANTIATE_TEST_SUITE_P(Storages, H5Layout,
                         ::testing::Values(h5::Storage{}, h5::Storage{.chunked = false},
                                           h5::Storage{.deflate = 0}, h5::Storage{.deflate = 9}));

class H5 : public FolderTest {
 protected:
  File created() const { return File::create(folder_ / "a.h5"); }
  File written(const std::function<void(File&)>& fill) const {
    return File::open(written_h5(folder_ / "a.h5", fill));
  }
};

TEST_F(H5, MatricesVectorsAndScalarsOfEveryTypeSurviveARoundTrip) {
  const RowMatrix f64 = counted(7, 3) / 3.0;
  const RowMatrixF f32 = f64.cast<float>(), wide = RowMatrixF::Random(2, 1'000'000);
  const Vector vector = Vector::LinSpaced(3, 1.0, 3.0);
  const std::vector<std::int64_t> i64 = {-2, -1, 0, 1, 2};
  const std::vector<std::uint8_t> u8(4, 255);
  const std::vector<std::string> texts = {"theta", "", "\xC3\xA9", std::string(100'000, 'x')};
  const File read = written([&](File& file) {
    file.write("f64", f64);
    file.write("f32", f32);
    file.write("vector", vector);
    file.write("i64", i64);
    file.write("u8", u8);
    file.write("none", RowMatrix(0, 3));
    file.write("wide", wide, {.deflate = 1});
    file.create_dataset("scalar", ElementType::f64, {}).write_rows<double>(0, 1, std::array{0.1});
    file.write("texts", texts);
    file.write("no_texts", std::vector<std::string>{});
  });
  EXPECT_EQ(read.names(), (std::vector<std::string>{"f32", "f64", "i64", "no_texts", "none",
                                                    "scalar", "texts", "u8", "vector", "wide"}));
  EXPECT_EQ(read.read_matrix<double>("f64", 7, 3), f64);
  EXPECT_EQ(read.read_matrix<float>("f32"), f32);
  EXPECT_EQ(read.read_matrix<double>("f32"), f32.cast<double>()) << "a wider type is exact";
  EXPECT_EQ(read.dataset("vector").shape(), h5::Shape{3});
  EXPECT_EQ(read.dataset("vector").read<double>(), (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(read.dataset("i64").read<std::int64_t>(), i64);
  EXPECT_EQ(read.dataset("i64").read<double>(), std::vector<double>(i64.begin(), i64.end()));
  EXPECT_EQ(read.dataset("u8").read<std::uint8_t>(), u8);
  EXPECT_EQ(read.dataset("u8").read<double>(), std::vector<double>(u8.begin(), u8.end()));
  EXPECT_EQ(read.dataset("u8").type(), ElementType::u8);
  EXPECT_EQ(read.read_matrix<double>("none").cols(), 3);
  EXPECT_EQ(read.read_matrix<float>("wide"), wide) << "in chunks that fit the cache";
  EXPECT_EQ(read.dataset("scalar").read<double>(), std::vector<double>{0.1});
  EXPECT_EQ(read.dataset("texts").read<std::string>(), texts);
  EXPECT_EQ(read.dataset("no_texts").read<std::string>(), std::vector<std::string>{});
}

TEST_F(H5, AttributesSurviveARoundTripAndCanBeReplaced) {
  const File read = written([](File& file) {
    file.set_attribute("number", 1.0);
    file.set_attribute("number", 0.1);
    file.set_attribute("count", Index{1} << 62);
    file.set_attribute("text", std::string(200'000, 'j'));
    h5::Group group = file.create_group("group");
    group.set_attribute("numbers", std::vector<double>{1.0, 2.0});
    group.set_attribute("counts", std::vector<Index>{3, 4});
    h5::Dataset dataset = group.create_dataset("d", ElementType::f64, {1});
    dataset.set_attribute("texts", std::vector<std::string>{"a", "b"});
  });
  EXPECT_EQ(read.attribute<double>("number"), 0.1);
  EXPECT_EQ(read.attribute<Index>("count"), Index{1} << 62);
  EXPECT_EQ(read.attribute<double>("count"), 0x1p62) << "an integer is a number";
  EXPECT_EQ(read.attribute<std::string>("text").size(), 200'000u) << "beyond HDF5's 64 KiB";
  EXPECT_EQ(read.attribute<std::vector<std::string>>("text").size(), 1u);
  EXPECT_EQ(read.attribute_names(), (std::vector<std::string>{"count", "number", "text"}));
  EXPECT_EQ(read.group("group").attribute<std::vector<double>>("numbers")[1], 2.0);
  EXPECT_EQ(read.group("group").attribute<std::vector<Index>>("counts")[1], 4);
  const h5::Dataset again = read.group("group").dataset("d");
  EXPECT_EQ(again.attribute<std::vector<std::string>>("texts")[1], "b");
  EXPECT_EQ(again.where(), (folder_ / "a.h5").string() + ": dataset 'group/d'");
}

TEST_F(H5, DimensionsHaveLabels) {
  const std::vector<std::string> labels = {"row", "parameter"};
  const File read = written([&](File& file) {
    file.write("theta", counted(2, 3)).label_dimensions(labels);
    file.create_virtual_dataset("x", ElementType::f64, {2, 3}, {}).label_dimensions(labels);
    h5::Dataset plain = file.write("plain", counted(2, 3));
    EXPECT_EQ(message_of<ShapeError>([&] { plain.label_dimensions({"row"}); }, &folder_),
              "a.h5: dataset 'plain' has shape (2, 3): 1 labels don't name its dimensions");
  });
  for (const char* name : {"theta", "x"}) {
    EXPECT_EQ(read.dataset(name).attribute<std::vector<std::string>>("DIMENSION_LABELS"), labels);
  }
  EXPECT_FALSE(read.dataset("plain").has_attribute("DIMENSION_LABELS"));
}

TEST_F(H5, SaysWhatIsMissing) {
  File file = created();
  file.write("theta", counted(2, 2));
  EXPECT_TRUE(says(problem([&] { file.dataset("thet"); }),
                   {"a.h5: has no dataset 'thet'", "'theta'", "it has theta"}));
  EXPECT_TRUE(
      says(problem([&] { file.group("theta"); }), {"a.h5: has no group 'theta'", "it has theta"}));
  EXPECT_EQ(problem([&] { file.dataset("theta").attribute<double>("dt"); }),
            "a.h5: dataset 'theta': attribute 'dt' is missing");
  EXPECT_EQ(problem([&] { File::open(folder_ / "b.h5"); }), "b.h5: doesn't exist");
  EXPECT_EQ(problem([&] { File::open(folder_.path()); }),
            folder_.path().string() + ": is a folder, must be an HDF5 file");
  for (const char* text : {"hello", ""}) {
    EXPECT_EQ(problem([&] { File::open(folder_.file("c.h5", text)); }), "c.h5: isn't an HDF5 file");
  }
}

TEST_F(H5, SaysWhichShapeTypeAndCountWereFound) {
  File file = created();
  file.write("theta", counted(2, 3));
  file.write("counts", VectorX<std::int64_t>{{-3, 0, (std::int64_t{1} << 53) - 1}});
  file.set_attribute("dts", std::vector<double>{1.0, 2.0});
  file.set_attribute("count", Index{3});
  RowMatrix values = counted(4, 3);
  values(2, 1) = kNaN;
  file.write("nan", values);
  EXPECT_TRUE(std::isnan(file.read_matrix<double>("nan")(2, 1)));
  const h5::Dataset theta = file.dataset("theta");
  const std::string shape = "dataset 'theta' has shape (2, 3), must be ";
  const std::string type = "dataset 'theta' holds 64-bit floats, must hold ";
  const std::vector<std::pair<std::string, std::function<void()>>> cases = {
      {shape + "(any, 4)", [&] { file.read_matrix<double>("theta", -1, 4); }},
      {shape + "(any)", [&] { theta.require_shape({-1}); }},
      {type + "32-bit floats", [&] { file.read_matrix<float>("theta"); }},
      {type + "64-bit integers", [&] { file.read_matrix<std::int64_t>("theta"); }},
      {type + "texts", [&] { theta.read<std::string>(); }},
      {"attribute 'dts' holds 2 values, must hold one", [&] { file.attribute<double>("dts"); }},
      {"attribute 'count' holds 64-bit integers, must hold texts",
       [&] { file.attribute<std::string>("count"); }},
      {"dataset 'counts' holds 64-bit integers, must hold 32-bit floats",
       [&] { file.dataset("counts").read<float>(); }},
      {"dataset 'nan' holds nan at (2, 1), must be finite",
       [&] { file.read_matrix<double>("nan", 4, 3, h5::Values::finite); }}};
  for (const auto& [said, read] : cases) EXPECT_TRUE(says(problem(read), {"a.h5: " + said}));
}

TEST_F(H5, RowsThatDontExistAreABugOfTheCaller) {
  File file = created();
  file.write("theta", counted(4, 2));
  h5::Dataset theta = file.dataset("theta");
  std::vector<double> rows(4);
  EXPECT_EQ(message_of<ShapeError>([&] { theta.read_rows<double>(3, 2, rows); }, &folder_),
            "a.h5: dataset 'theta' has 4 rows: rows 3 to 4 don't exist");
  EXPECT_THROW(theta.read_rows<double>(-1, 2, rows), ShapeError);
  EXPECT_EQ(message_of<ShapeError>([&] { theta.write_rows<double>(0, 1, rows); }, &folder_),
            "a.h5: dataset 'theta': 1 rows have 2 values, not 4");
}

TEST_F(H5, ATextWithANulIsRefused) {
  File file = created();
  EXPECT_EQ(
      message_of<Error>([&] { file.write("t", std::vector{std::string("a\0b", 3)}); }, &folder_),
      "a.h5: dataset 't': can't hold a text with a NUL character");
}

}  // namespace
}  // namespace npdr::pipeline
