#include "pipeline/store/h5.h"

#include <array>
#include <numeric>

#include "core/constants.h"
#include "counted.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using h5::ElementType;
using h5::File;

TEST(H5, MatricesVectorsAndScalarsOfEveryTypeSurviveARoundTrip) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  const RowMatrix f64 = counted(7, 3) / 3.0;
  const RowMatrixF f32 = f64.cast<float>();
  const VectorX<std::int64_t> i64 = VectorX<std::int64_t>::LinSpaced(5, -2, 2);
  const VectorX<std::uint8_t> u8 = VectorX<std::uint8_t>::Constant(4, 255);
  file.write("f64", f64);
  file.write("f32", f32);
  file.write("i64", i64);
  file.write("u8", u8);
  file.create_dataset("scalar", ElementType::f64, {}).write_rows<double>(0, 1, std::array{0.1});
  file.close();

  const File read = File::open(folder / "a.h5");
  EXPECT_EQ(read.names(), (std::vector<std::string>{"f32", "f64", "i64", "scalar", "u8"}));
  EXPECT_EQ(read.read_matrix<double>("f64", 7, 3), f64);
  EXPECT_EQ(read.read_matrix<float>("f32"), f32);
  EXPECT_EQ(read.read_matrix<double>("f32"), f32.cast<double>()) << "a wider type is exact";
  EXPECT_EQ(read.read_vector<std::int64_t>("i64", 5), i64);
  EXPECT_EQ(read.read_vector<std::uint8_t>("u8"), u8);
  EXPECT_EQ(read.read_scalar<double>("scalar"), 0.1);
  EXPECT_EQ(read.dataset("u8").type(), ElementType::u8);
}

TEST(H5, TextsSurviveARoundTrip) {
  const TempFolder folder;
  const std::vector<std::string> texts = {"theta", "", "\xC3\xA9", std::string(100'000, 'x')};
  File file = File::create(folder / "a.h5");
  file.write_texts("texts", texts);
  file.write_texts("none", {});
  file.write_text("text", "one");
  file.close();
  const File read = File::open(folder / "a.h5");
  EXPECT_EQ(read.read_texts("texts"), texts);
  EXPECT_EQ(read.read_texts("none"), std::vector<std::string>{});
  EXPECT_EQ(read.read_text("text"), "one");
}

TEST(H5, AttributesSurviveARoundTripAndCanBeReplaced) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  file.set_attribute("number", 1.0);
  file.set_attribute("number", 0.1);
  file.set_attribute("count", Index{1} << 62);
  file.set_attribute("text", std::string(200'000, 'j'));
  h5::Group group = file.create_group("group");
  group.set_attribute("numbers", std::vector<double>{1.0, 2.0});
  group.set_attribute("counts", std::vector<Index>{3, 4});
  h5::Dataset dataset = group.create_dataset("d", ElementType::f64, {1});
  dataset.set_attribute("texts", std::vector<std::string>{"a", "b"});
  file.close();

  const File read = File::open(folder / "a.h5");
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
  EXPECT_EQ(again.where(), (folder / "a.h5").string() + ": dataset 'group/d'");
}

class H5Layout : public ::testing::TestWithParam<h5::Storage> {};

TEST_P(H5Layout, RowsCanBeWrittenAndReadInAnyBlocks) {
  const TempFolder folder;
  const h5::Shape shape = {10, 3, 4, 2};
  std::vector<float> values(240);
  std::iota(values.begin(), values.end(), 0.0f);
  File file = File::create(folder / "a.h5");
  h5::Dataset dataset = file.create_dataset("x", ElementType::f32, shape, GetParam());
  EXPECT_EQ(dataset.row_size(), 24);
  for (const Index begin : {7, 0, 3}) {
    const Index count = begin == 3 ? 4 : 3;
    dataset.write_rows<float>(begin, count, std::span(values).subspan(begin * 24, count * 24));
  }
  file.close();

  const File read = File::open(folder / "a.h5");
  const h5::Dataset stored = read.dataset("x");
  EXPECT_EQ(stored.shape(), shape);
  EXPECT_EQ(stored.read<float>(), values);
  std::vector<float> rows(48);
  stored.read_rows<float>(5, 2, rows);
  EXPECT_TRUE(std::equal(rows.begin(), rows.end(), values.begin() + 120));
}

INSTANTIATE_TEST_SUITE_P(Storages, H5Layout,
                         ::testing::Values(h5::Storage{}, h5::Storage{.chunked = false},
                                           h5::Storage{.deflate = 0},
                                           h5::Storage{.deflate = 9, .rows_per_chunk = 4}));

TEST(H5, DimensionsHaveLabels) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  file.write("theta", counted(2, 3)).label_dimensions({"row", "parameter"});
  file.write("plain", counted(2, 3));
  h5::Dataset joined = file.create_virtual_dataset("x", ElementType::f64, {2, 3}, {});
  joined.label_dimensions({"row", "parameter"});
  EXPECT_EQ(
      message_of<ShapeError>([&] { file.dataset("plain").label_dimensions({"row"}); }, &folder),
      "a.h5: dataset 'plain' has shape (2, 3): 1 labels don't name its dimensions");
  file.close();
  const File read = File::open(folder / "a.h5");
  const std::vector<std::string> labels = {"row", "parameter"};
  EXPECT_EQ(read.dataset("theta").dimension_labels(), labels);
  EXPECT_EQ(read.dataset("x").dimension_labels(), labels);
  EXPECT_EQ(read.dataset("plain").dimension_labels(), (std::vector<std::string>{"", ""}));
  EXPECT_EQ(read.dataset("theta").attribute<std::vector<std::string>>("DIMENSION_LABELS"), labels);
}

TEST(H5, EmptyArraysAreFine) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  file.write("none", RowMatrix(0, 3));
  file.close();
  EXPECT_EQ(File::open(folder / "a.h5").read_matrix<double>("none").cols(), 3);
}

TEST(H5, LongRowsAreCutIntoChunksThatFitTheCache) {
  const TempFolder folder;
  const RowMatrixF wide = RowMatrixF::Random(2, 1'000'000);
  File file = File::create(folder / "a.h5");
  file.write("wide", wide, {.deflate = 1});
  file.close();
  EXPECT_EQ(File::open(folder / "a.h5").read_matrix<float>("wide"), wide);
}

TEST(H5, SaysWhatIsMissing) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  file.write("theta", counted(2, 2));
  const auto message = [&](const auto& body) { return message_of<InputError>(body, &folder); };
  EXPECT_TRUE(says(message([&] { file.dataset("thet"); }),
                   {"a.h5: has no dataset 'thet'", "'theta'", "it has theta"}));
  EXPECT_TRUE(
      says(message([&] { file.group("theta"); }), {"a.h5: has no group 'theta'", "it has theta"}));
  EXPECT_EQ(message([&] { file.dataset("theta").attribute<double>("dt"); }),
            "a.h5: dataset 'theta': attribute 'dt' is missing");
  EXPECT_EQ(message([&] { File::open(folder / "b.h5"); }), "b.h5: doesn't exist");
  EXPECT_EQ(message([&] { File::open(folder.path()); }),
            folder.path().string() + ": is a folder, must be an HDF5 file");
  EXPECT_EQ(message([&] { File::open(folder.file("c.h5", "hello")); }), "c.h5: isn't an HDF5 file");
  EXPECT_EQ(message([&] { File::open(folder.file("d.h5", "")); }), "d.h5: isn't an HDF5 file");
}

TEST(H5, SaysWhichShapeTypeAndCountWereFound) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  file.write("theta", counted(2, 3));
  file.set_attribute("dts", std::vector<double>{1.0, 2.0});
  file.set_attribute("count", Index{3});
  const auto message = [&](const auto& body) { return message_of<InputError>(body, &folder); };
  EXPECT_TRUE(says(message([&] { file.read_matrix<double>("theta", -1, 4); }),
                   {"a.h5: dataset 'theta' has shape (2, 3)", "must be (any, 4)"}));
  EXPECT_TRUE(says(message([&] { file.read_vector<double>("theta"); }),
                   {"a.h5: dataset 'theta' has shape (2, 3)", "must be (any)"}));
  EXPECT_TRUE(says(message([&] { file.read_matrix<float>("theta"); }),
                   {"a.h5: dataset 'theta' holds 64-bit floats", "must hold 32-bit floats"}));
  EXPECT_TRUE(says(message([&] { file.read_matrix<std::int64_t>("theta"); }),
                   {"a.h5: dataset 'theta' holds 64-bit floats", "must hold 64-bit integers"}));
  EXPECT_TRUE(says(message([&] { file.dataset("theta").read_texts(); }),
                   {"a.h5: dataset 'theta' holds 64-bit floats", "must hold texts"}));
  EXPECT_TRUE(says(message([&] { file.attribute<double>("dts"); }),
                   {"a.h5: attribute 'dts' holds 2 values", "must hold one"}));
  EXPECT_TRUE(says(message([&] { file.attribute<std::string>("count"); }),
                   {"a.h5: attribute 'count' holds 64-bit integers", "must hold texts"}));
}

TEST(H5, IntegersAreReadAsDoublesButNotTheOtherWayAround) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  const VectorX<std::int64_t> counts{{-3, 0, (std::int64_t{1} << 53) - 1}};
  file.write("counts", counts);
  EXPECT_EQ(file.read_vector<double>("counts"), counts.cast<double>());
  const VectorX<std::uint8_t> bytes{{0, 255}};
  file.write("bytes", bytes);
  EXPECT_EQ(file.read_vector<double>("bytes"), bytes.cast<double>());
  EXPECT_TRUE(says(message_of<InputError>([&] { file.read_vector<float>("counts"); }, &folder),
                   {"a.h5: dataset 'counts' holds 64-bit integers", "must hold 32-bit floats"}));
}

TEST(H5, SaysWhereAValueIsntFinite) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  RowMatrix values = counted(4, 3);
  values(2, 1) = kNaN;
  file.write("theta", values);
  EXPECT_TRUE(std::isnan(file.read_matrix<double>("theta")(2, 1)));
  EXPECT_TRUE(
      says(message_of<InputError>(
               [&] { file.read_matrix<double>("theta", 4, 3, h5::Values::finite); }, &folder),
           {"a.h5: dataset 'theta' holds nan at (2, 1)", "must be finite"}));
}

TEST(H5, RowsThatDontExistAreABugOfTheCaller) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  file.write("theta", counted(4, 2));
  h5::Dataset theta = file.dataset("theta");
  std::vector<double> rows(4);
  EXPECT_EQ(message_of<ShapeError>([&] { theta.read_rows<double>(3, 2, rows); }, &folder),
            "a.h5: dataset 'theta' has 4 rows: rows 3 to 4 don't exist");
  EXPECT_THROW(theta.read_rows<double>(-1, 2, rows), ShapeError);
  EXPECT_EQ(message_of<ShapeError>([&] { theta.write_rows<double>(0, 1, rows); }, &folder),
            "a.h5: dataset 'theta': 1 rows have 2 values, not 4");
}

TEST(H5, ATextWithANulIsRefused) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  EXPECT_EQ(message_of<Error>([&] { file.write_text("t", std::string("a\0b", 3)); }, &folder),
            "a.h5: dataset 't': can't hold a text with a NUL character");
}

}  // namespace
}  // namespace npdr::pipeline
