// Opening, closing and joining HDF5 files.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <ctime>

#include "pipeline/store/h5.h"
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
}

TEST_F(H5File, AVirtualDatasetCanBeReadFromAnotherCurrentFolder) {
  write_joined();
  const auto old = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  const RowMatrix values = File::open("joined.h5").read_matrix<double>("x");
  std::filesystem::current_path(old);
  EXPECT_EQ(values, counted(6, 3));
}

TEST_F(H5File, AVirtualDatasetWithoutItsPartsIsRefused) {
  write_joined();
  written_h5(folder_ / "part1.h5", [](File& part) { part.write("x", counted(1, 3)); });
  EXPECT_TRUE(says(refusal(), {"joined.h5: dataset 'x'", "5 rows", "6"}));
  std::filesystem::remove(folder_ / "part1.h5");
  EXPECT_TRUE(says(refusal(), {"joined.h5: dataset 'x': its part 'part1.h5' is missing",
                               "remove the joined file and rerun stage 'simulate'"}));
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

TEST_F(H5File, AVirtualDatasetInAnotherOrderThanItsPartsIsRefused) {
  write_joined();
  // The mapping says that part 0 has one row and the others come after it.
  join(6, {{"part0.h5", "x", 1}, {"part1.h5", "x", 2}, {"part2.h5", "x", 2}});
  EXPECT_TRUE(says(refusal(), {"joined.h5: dataset 'x': its rows",
                               "must be those of its parts, one after the other"}));
}

TEST_F(H5File, AVirtualDatasetNamesItsPartFiles) {
  write_joined();
  const auto here = std::filesystem::canonical(folder_.path());
  EXPECT_EQ(File::open(folder_ / "joined.h5").dataset("x").part_files(),
            (std::vector{here / "part0.h5", here / "part1.h5", here / "part2.h5"}));
  EXPECT_TRUE(File::open(folder_ / "part0.h5").dataset("x").part_files().empty());
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

TEST_F(H5File, DoesntOpenAFileThatSomebodyElseWrites) {
  const auto path = written_h5(folder_ / "a.h5", [](File&) {});
  const int somebody = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(somebody, LOCK_EX), 0);
  EXPECT_EQ(
      message_of<Error>([&] { File::open(path); }, &folder_),
      "a.h5: can't be opened: unable to lock file: Resource temporarily unavailable; try again "
      "later");
  ::close(somebody);
}

TEST_F(H5File, ANameTooLongForTheFileSystemIsNoSurprise) {
  const std::string name(5000, 'a');
  EXPECT_EQ(problem([&] { File::open(name); }),
            name + ": can't be opened: unable to open file: File name too long");
}

}  // namespace
}  // namespace npdr::pipeline
