#include <hdf5_hl.h>
#include <sys/resource.h>

#include <ctime>

#include "core/error.h"
#include "pipeline/store/h5.h"
#include "pipeline/store/netcdf.h"
#include "tests/pipeline/store/written_h5.h"
#include "tests/temp_folder.h"
#include "tests/wait_for.h"

namespace npdr::pipeline {
namespace {

using h5::ElementType;
using h5::File;

class H5File : public FolderTest {
 protected:
  // Files of `rows` rows of 'x' each, counted from 0, and one that joins them.
  void write_joined(Index num_parts = 3, Index rows = 2) const {
    std::vector<h5::VirtualSource> parts;
    for (Index i = 0; i < num_parts; ++i) {
      const std::string name = "part" + std::to_string(i) + ".h5";
      const RowMatrix x = counted(rows, 3).array() + 3.0 * static_cast<double>(rows * i);
      written_h5(folder_ / name, [&](File& part) { part.write("x", x); });
      parts.push_back({name, "x", rows});
    }
    join(num_parts * rows, parts);
  }
  void join(Index rows, const std::vector<h5::VirtualSource>& parts) const {
    written_h5(folder_ / "joined.h5", [&](File& file) {
      file.create_virtual_dataset("x", ElementType::f64, {rows, 3}, parts);
    });
  }
  RowMatrix joined() const { return File::open(folder_ / "joined.h5").read_matrix<double>("x"); }
  std::string refusal() const {
    return problem([&] { joined(); });
  }
};

TEST_F(H5File, AVirtualDatasetIsReadLikeItsParts) {
  write_joined();
  const h5::Dataset x = File::open(folder_ / "joined.h5").dataset("x");
  std::vector<double> row(3);
  for (const Index i : {5, 0, 3}) {
    x.read_rows<double>(i, 1, row);
    EXPECT_EQ(row[0], 3.0 * static_cast<double>(i));
  }
  EXPECT_EQ(joined(), counted(6, 3)) << "while the other one is open";
  const auto old = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  EXPECT_EQ(File::open("joined.h5").read_matrix<double>("x"), counted(6, 3));
  std::filesystem::current_path(old);
  const auto here = std::filesystem::canonical(folder_.path());
  EXPECT_EQ(x.part_files(), (std::vector{here / "part0.h5", here / "part1.h5", here / "part2.h5"}));
  EXPECT_TRUE(File::open(folder_ / "part0.h5").dataset("x").part_files().empty());
}

TEST_F(H5File, AVirtualDatasetWithoutItsPartsOrInAnotherOrderIsRefused) {
  write_joined();
  written_h5(folder_ / "part1.h5", [](File& part) { part.write("x", counted(1, 3)); });
  EXPECT_TRUE(says(refusal(), {"joined.h5: dataset 'x'", "5 rows", "6"}));
  std::filesystem::remove(folder_ / "part1.h5");
  EXPECT_TRUE(says(refusal(), {"joined.h5: dataset 'x': its part 'part1.h5' is missing",
                               "remove the joined file and rerun stage 'simulate'"}));
  write_joined();
  // The mapping says that part 0 has one row and the others come after it.
  join(6, {{"part0.h5", "x", 1}, {"part1.h5", "x", 2}, {"part2.h5", "x", 2}});
  EXPECT_TRUE(says(refusal(), {"joined.h5: dataset 'x': its rows",
                               "must be those of its parts, one after the other"}));
}

TEST_F(H5File, AVirtualDatasetMayHaveMorePartsThanAProcessMayOpenFiles) {
  write_joined(100, 1);
  rlimit old = {};
  ::getrlimit(RLIMIT_NOFILE, &old);
  const rlimit few = {40, old.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &few);
  const RowMatrix values = joined();
  ::setrlimit(RLIMIT_NOFILE, &old);
  EXPECT_EQ(values, counted(100, 3));
}

TEST_F(H5File, ADamagedPartOfAVirtualDatasetIsNamed) {
  write_joined();
  const double last = 11.0;
  const std::string value(reinterpret_cast<const char*>(&last), sizeof last);
  written_h5(folder_ / "part1.h5", [](File& part) {
    part.write("x", RowMatrix(counted(2, 3).array() + 6.0), {.deflate = 0});
  });
  std::string bytes = text_of(folder_ / "part1.h5");
  const std::size_t at = bytes.find(value);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 1;
  folder_.file("part1.h5", bytes);
  EXPECT_TRUE(
      says(refusal(),
           {"part1.h5: dataset 'x': can't be read: data error detected by Fletcher32 checksum",
            "remove it and 'joined.h5'"}));
}

TEST_F(H5File, ClosingAFileClosesWhatIsOpenInIt) {
  File file = File::create(folder_ / "a.h5");
  h5::Dataset dataset = file.create_dataset("x", ElementType::f64, {1});
  dataset.write_rows<double>(0, 1, std::vector<double>{3.0});
  file.close();
  const h5::Dataset x = File::open(folder_ / "a.h5").dataset("x");
  EXPECT_EQ(x.read<double>(), std::vector<double>{3.0}) << "a dataset keeps its file open";
}

TEST_F(H5File, EqualContentGivesEqualFiles) {
  for (const char* name : {"a.h5", "b.h5"}) {
    written_h5(folder_ / name, [](File& file) {
      file.write("theta", counted(100, 3));
      file.create_group("group").set_attribute("name", std::string("a"));
      file.create_virtual_dataset("x", ElementType::f64, {2, 3}, {{"part.h5", "x", 2}});
    });
    // HDF5 counts times of creation in seconds.
    const std::time_t made = std::time(nullptr);
    EXPECT_TRUE(comes_true([&] { return std::time(nullptr) != made; }));
  }
  EXPECT_EQ(text_of(folder_ / "a.h5"), text_of(folder_ / "b.h5"));
}

TEST_F(H5File, SaysWhyItCantBeOpened) {
  const std::string name(5000, 'a');
  EXPECT_EQ(problem([&] { File::open(name); }),
            name + ": can't be opened: unable to open file: File name too long");
}

class Netcdf : public FolderTest {
 protected:
  Netcdf() : file_(h5::File::create(folder_ / "a.nc")), group_(file_.create_group("posterior")) {
    group_.dimension("chain", std::vector<Index>{1, 2});
    group_.dimension("name", std::vector<std::string>{"a", "\u00e4", ""});
  }

  h5::File reopened() {
    file_.close();
    return h5::File::open(folder_ / "a.nc");
  }

  h5::File file_;
  NetcdfGroup group_;
};

TEST_F(Netcdf, EveryAxisHasTheScaleOfItsName) {
  group_.variable("x", {"chain", "name"}, std::vector<double>{1, 2, 3, 4, 5, 6}, "kg");
  group_.variable("dt", {}, std::vector<double>{0.5});
  const h5::File file = reopened();
  const h5::Group group = file.group("posterior");
  const h5::Dataset x = group.dataset("x");
  EXPECT_EQ(x.read<double>(), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(x.attribute<std::string>("units"), "kg");
  for (const auto& [axis, name] : {std::pair{0u, "chain"}, {1u, "name"}}) {
    const h5::Dataset scale = group.dataset(name);
    EXPECT_GT(H5DSis_scale(scale.id()), 0);
    EXPECT_GT(H5DSis_attached(x.id(), scale.id(), axis), 0);
  }
  EXPECT_EQ(H5DSis_attached(x.id(), group.dataset("name").id(), 0), 0);
  EXPECT_EQ(group.dataset("name").read<std::string>(),
            (std::vector<std::string>{"a", "\u00e4", ""}));
  EXPECT_EQ(group.dataset("dt").read<double>(), std::vector<double>{0.5});
}

TEST_F(Netcdf, NamesThatItForbidsAreReplaced) {
  group_.variable("chain", {"chain"}, std::vector<float>{1, 2});
  group_.variable("a/b ", {"chain"}, std::vector<float>{1, 2});
  const h5::File file = reopened();
  EXPECT_EQ(file.group("posterior").names(),
            (std::vector<std::string>{"a_b", "chain", "chain_", "name"}));
}

TEST_F(Netcdf, ADimensionMustBeThere) {
  EXPECT_TRUE(
      says(message_of<ShapeError>([&] { group_.variable("x", {"draw"}, std::vector<double>{1}); }),
           {"x: there is no dimension draw"}));
}

}  // namespace
}  // namespace npdr::pipeline
