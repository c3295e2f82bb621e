// Opening, closing and joining HDF5 files.
#include <sys/resource.h>

#include <ctime>

#include "counted.h"
#include "pipeline/store/h5.h"
#include "tests/file_size_limit.h"
#include "tests/temp_folder.h"
#include "tests/wait_for.h"

namespace npdr::pipeline {
namespace {

using h5::ElementType;
using h5::File;

// Three files of two rows of 'x' each, counted from 0, and one that joins them.
void write_joined(const TempFolder& folder) {
  std::vector<h5::VirtualSource> parts;
  for (int i = 0; i < 3; ++i) {
    const std::string name = "part" + std::to_string(i) + ".h5";
    File part = File::create(folder / name);
    part.write("x", RowMatrix(counted(2, 3).array() + 6.0 * i));
    part.close();
    parts.push_back({name, "x", 2});
  }
  File file = File::create(folder / "joined.h5");
  file.create_virtual_dataset("x", ElementType::f64, {6, 3}, parts);
  file.close();
}

TEST(H5File, AVirtualDatasetIsReadLikeItsParts) {
  const TempFolder folder;
  write_joined(folder);
  const File file = File::open(folder / "joined.h5");
  const h5::Dataset x = file.dataset("x");
  std::vector<double> row(3);
  for (const Index i : {5, 0, 3}) {
    x.read_rows<double>(i, 1, row);
    EXPECT_EQ(row[0], 3.0 * static_cast<double>(i));
  }
  EXPECT_EQ(file.read_matrix<double>("x"), counted(6, 3)) << "while the other one is open";
}

TEST(H5File, AVirtualDatasetCanBeReadFromAnotherCurrentFolder) {
  const TempFolder folder;
  write_joined(folder);
  const auto old = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const RowMatrix values = File::open("joined.h5").read_matrix<double>("x");
  std::filesystem::current_path(old);
  EXPECT_EQ(values, counted(6, 3));
}

TEST(H5File, AVirtualDatasetWithoutItsPartsIsRefused) {
  const TempFolder folder;
  write_joined(folder);
  const auto reading = [&] {
    return message_of<InputError>(
        [&] { File::open(folder / "joined.h5").read_matrix<double>("x"); }, &folder);
  };
  File part = File::create(folder / "part1.h5");
  part.write("x", RowMatrix(counted(1, 3)));
  part.close();
  EXPECT_TRUE(says(reading(), {"joined.h5: dataset 'x'", "5 rows", "6"}));
  std::filesystem::remove(folder / "part1.h5");
  EXPECT_TRUE(says(reading(), {"joined.h5: dataset 'x': its part 'part1.h5' is missing",
                               "remove the joined file and rerun stage 'simulate'"}));
}

TEST(H5File, AVirtualDatasetMayHaveMorePartsThanAProcessMayOpenFiles) {
  const TempFolder folder;
  constexpr Index num_parts = 100;
  std::vector<h5::VirtualSource> parts;
  for (Index i = 0; i < num_parts; ++i) {
    const std::string name = "part" + std::to_string(i) + ".h5";
    File part = File::create(folder / name);
    part.write("x", RowMatrix(counted(1, 3).array() + 3.0 * static_cast<double>(i)));
    part.close();
    parts.push_back({name, "x", 1});
  }
  File file = File::create(folder / "joined.h5");
  file.create_virtual_dataset("x", ElementType::f64, {num_parts, 3}, parts);
  file.close();
  rlimit old = {};
  ::getrlimit(RLIMIT_NOFILE, &old);
  const rlimit few = {40, old.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &few);
  const RowMatrix values = File::open(folder / "joined.h5").read_matrix<double>("x");
  ::setrlimit(RLIMIT_NOFILE, &old);
  EXPECT_EQ(values, counted(num_parts, 3));
}

TEST(H5File, ADamagedPartOfAVirtualDatasetIsNamed) {
  const TempFolder folder;
  write_joined(folder);
  const double last = 11.0;
  const std::string value(reinterpret_cast<const char*>(&last), sizeof last);
  File part = File::create(folder / "part1.h5");
  part.write("x", RowMatrix(counted(2, 3).array() + 6.0), {.deflate = 0});
  part.close();
  std::string bytes = text_of(folder / "part1.h5");
  const std::size_t at = bytes.find(value);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 1;
  folder.file("part1.h5", bytes);
  EXPECT_TRUE(
      says(message_of<InputError>(
               [&] { File::open(folder / "joined.h5").read_matrix<double>("x"); }, &folder),
           {"part1.h5: dataset 'x': can't be read: data error detected by Fletcher32 checksum",
            "remove it and 'joined.h5'"}));
}

TEST(H5File, AVirtualDatasetInAnotherOrderThanItsPartsIsRefused) {
  const TempFolder folder;
  write_joined(folder);
  File file = File::create(folder / "joined.h5");
  // The mapping says that part 0 has one row and the others come after it.
  file.create_virtual_dataset("x", ElementType::f64, {6, 3},
                              {{"part0.h5", "x", 1}, {"part1.h5", "x", 2}, {"part2.h5", "x", 2}});
  file.close();
  EXPECT_TRUE(says(
      message_of<InputError>([&] { File::open(folder / "joined.h5").read_matrix<double>("x"); },
                             &folder),
      {"joined.h5: dataset 'x': its rows", "must be those of its parts, one after the other"}));
}

TEST(H5File, AVirtualDatasetNamesItsPartFiles) {
  const TempFolder folder;
  write_joined(folder);
  const auto joined = std::filesystem::canonical(folder.path());
  EXPECT_EQ(File::open(folder / "joined.h5").dataset("x").part_files(),
            (std::vector{joined / "part0.h5", joined / "part1.h5", joined / "part2.h5"}));
  EXPECT_TRUE(File::open(folder / "part0.h5").dataset("x").part_files().empty());
}

TEST(H5File, ClosingAFileClosesWhatIsOpenInIt) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  h5::Dataset dataset = file.create_dataset("x", ElementType::f64, {1});
  dataset.write_rows<double>(0, 1, std::vector<double>{3.0});
  file.close();
  EXPECT_EQ(File::open(folder / "a.h5").read_vector<double>("x")(0), 3.0);
}

TEST(H5File, ADatasetKeepsTheFileThatItIsReadFromOpen) {
  const TempFolder folder;
  File file = File::create(folder / "a.h5");
  file.write("x", counted(2, 2));
  file.close();
  const h5::Dataset x = File::open(folder / "a.h5").dataset("x");
  EXPECT_EQ(x.read<double>(), (std::vector<double>{0.0, 1.0, 2.0, 3.0}));
}

TEST(H5File, EqualContentGivesEqualFiles) {
  const TempFolder folder;
  for (const char* name : {"a.h5", "b.h5"}) {
    File file = File::create(folder / name);
    file.write("theta", counted(100, 3));
    file.create_group("group").set_attribute("name", std::string("a"));
    file.create_virtual_dataset("x", ElementType::f64, {2, 3}, {{"part.h5", "x", 2}});
    file.close();
    // HDF5 counts times of creation in seconds.
    const std::time_t made = std::time(nullptr);
    EXPECT_TRUE(comes_true([&] { return std::time(nullptr) != made; }));
  }
  EXPECT_EQ(text_of(folder / "a.h5"), text_of(folder / "b.h5"));
}

TEST(H5File, AFailedWriteSaysWhyAndWhatToDo) {
  const TempFolder folder;
  const FileSizeLimit limit(100'000);
  EXPECT_TRUE(says(message_of<Error>(
                       [&] {
                         File file = File::create(folder / "a.h5");
                         file.write("x", RowMatrix(RowMatrix::Random(300, 300)));
                         file.close();
                       },
                       &folder),
                   {"a.h5: can't be written: file write failed: File too large",
                    "raise the limit on the size of a file (ulimit -f)"}));
}

TEST(H5File, ANameTooLongForTheFileSystemIsNoSurprise) {
  const std::string name(5000, 'a');
  EXPECT_EQ(message_of<InputError>([&] { File::open(name); }),
            name + ": can't be opened: unable to open file: File name too long");
}

}  // namespace
}  // namespace npdr::pipeline
