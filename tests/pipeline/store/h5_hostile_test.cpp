// Files that lie about what they hold. Only HDF5 itself can make them.
#include <hdf5.h>
#include <sys/stat.h>

#include <functional>

#include "pipeline/store/h5.h"
#include "tests/pipeline/store/written_h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using h5::File;

hid_t create(hid_t file, hid_t type, hid_t space, hid_t properties = H5P_DEFAULT) {
  return H5Dcreate2(file, "x", type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
}

hid_t simple_space(std::vector<hsize_t> extents) {
  return H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
}

hid_t chunked(const std::vector<hsize_t>& chunk) {
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
  return properties;
}

// Two values of a type, all of their bytes 0.
void write_zeros(hid_t file, hid_t type) {
  const hid_t dataset = create(file, type, simple_space({2}));
  const std::vector<char> zeros(2 * H5Tget_size(type));
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data());
  H5Dclose(dataset);
}

// A chunk of a dataset that claims to hold 10^9 times as many values.
void write_bomb(hid_t file) {
  const hsize_t begin = 0, count = 1000;
  const hid_t properties = chunked({count});
  H5Pset_deflate(properties, 9);
  const hid_t dataset = create(file, H5T_IEEE_F64LE, simple_space({1'000'000'000'000}), properties);
  const std::vector<double> values(count, 1.0);
  const hid_t all = H5Dget_space(dataset), memory = simple_space({count});
  H5Sselect_hyperslab(all, H5S_SELECT_SET, &begin, nullptr, &count, nullptr);
  H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory, all, H5P_DEFAULT, values.data());
  H5Dclose(dataset);
}

// With h5py's lzf.
void write_compressed_otherwise(hid_t file) {
  const hid_t properties = chunked({2});
  H5Pset_filter(properties, 32000, H5Z_FLAG_OPTIONAL, 0, nullptr);
  const hid_t dataset = create(file, H5T_IEEE_F64LE, simple_space({2}), properties);
  const double values[] = {1.0, 2.0};
  const hsize_t begin = 0;
  H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &begin, sizeof values, values);
  H5Dclose(dataset);
}

void write_records(hid_t file) {
  const hid_t record = H5Tcreate(H5T_COMPOUND, 16);
  H5Tinsert(record, "a", 0, H5T_NATIVE_DOUBLE);
  write_zeros(file, record);
}

void write_booleans(hid_t file) {
  const hid_t boolean = H5Tenum_create(H5T_NATIVE_INT8);
  const std::int8_t zero = 0;
  H5Tenum_insert(boolean, "FALSE", &zero);
  write_zeros(file, boolean);
}

// Bytes of another file.
void write_external(hid_t file) {
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(properties, "secret", 0, 16);
  H5Dclose(create(file, H5T_IEEE_F64LE, simple_space({2}), properties));
}

class HostileH5 : public FolderTest {
 protected:
  // A file that `make` fills, which gets its identifier.
  void make_file(const std::function<void(hid_t)>& make) const {
    const hid_t file =
        H5Fcreate((folder_ / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    make(file);
    ASSERT_GE(H5Fclose(file), 0);
  }
  std::string reading() const {
    return problem([&] { File::open(folder_ / "a.h5").dataset("x").read<double>(); });
  }
  // The bytes of a sound file.
  std::string sound() const {
    return text_of(written_h5(folder_ / "a.h5",
                              [](File& file) { file.write("x", Vector(Vector::Random(10'000))); }));
  }
};

TEST_F(HostileH5, WhatLiesIsRefusedAndNamed) {
  const std::string must = ", must hold 64-bit floats";
  const std::vector<std::pair<std::string, std::function<void(hid_t)>>> cases = {
      // Before anything is allocated.
      {"dataset 'x' claims shape (1000000000000) (8000000000000 bytes), but the file holds only ",
       write_bomb},
      {"dataset 'x': is compressed by '32000'", write_compressed_otherwise},
      {"dataset 'x' claims shape (4, 1000000000), but nothing was ever written to it",
       [](hid_t file) {
         H5Dclose(create(file, H5T_IEEE_F64LE, simple_space({4, 1'000'000'000})));
       }},
      {"dataset 'x': claims an impossible number of values",
       [](hid_t file) {
         const hid_t space = simple_space({1ull << 40, 1ull << 20});
         H5Dclose(create(file, H5T_IEEE_F64LE, space, chunked({1, 1})));
       }},
      {"dataset 'x' holds compound records" + must, write_records},
      {"dataset 'x' holds 128-bit floats" + must,
       [](hid_t file) { write_zeros(file, H5T_NATIVE_LDOUBLE); }},
      {"dataset 'x' holds texts" + must, [](hid_t file) { write_zeros(file, H5T_C_S1); }},
      {"dataset 'x' holds values of another type" + must,
       [](hid_t file) { write_zeros(file, H5Tcreate(H5T_OPAQUE, 4)); }},
      {"dataset 'x' holds enumerated values" + must, write_booleans},
      {"dataset 'x': holds no array",
       [](hid_t file) { H5Dclose(create(file, H5T_IEEE_F64LE, H5Screate(H5S_NULL))); }},
      {"'x' is a link that leads nowhere in this file",
       [](hid_t file) { H5Lcreate_soft("/nowhere", file, "x", H5P_DEFAULT, H5P_DEFAULT); }},
      {"dataset 'x': its values are bytes of other files, must be in this one", write_external},
      {"has no dataset 'x'", [](hid_t file) {
         H5Lcreate_external("other.h5", "/x", file, "x", H5P_DEFAULT, H5P_DEFAULT);
       }}};
  written_h5(folder_ / "other.h5", [](File& other) { other.write("x", Vector(Vector::Ones(2))); });
  for (const auto& [said, make] : cases) {
    make_file(make);
    EXPECT_TRUE(reading().starts_with("a.h5: " + said)) << reading();
  }
}

TEST_F(HostileH5, RowsOfAFileInAnotherFolderAreNotRead) {
  std::filesystem::create_directory(folder_ / "folder");
  const auto other =
      written_h5(folder_ / "other.h5", [](File& file) { file.write("x", counted(2, 3)); });
  File file = File::create(folder_ / "folder/a.h5");
  for (const auto& [name, part] :
       {std::pair("x", std::string("../other.h5")), {"y", other.string()}}) {
    EXPECT_TRUE(
        has(problem([&] {
              file.create_virtual_dataset(name, h5::ElementType::f64, {2, 3}, {{part, "x", 2}});
            }),
            "isn't in the folder of this file, or below it"));
  }
}

TEST_F(HostileH5, APipeIsNotWaitedFor) {
  ASSERT_EQ(mkfifo((folder_ / "a.h5").c_str(), 0600), 0);
  EXPECT_EQ(reading(), "a.h5: isn't a regular file, must be an HDF5 file");
}

TEST_F(HostileH5, DamageIsFound) {
  const std::string whole = sound();
  for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t{600}}) {
    folder_.file("a.h5", whole.substr(0, size));
    EXPECT_TRUE(reading().starts_with("a.h5: can't be opened: truncated file")) << reading();
  }
  std::string flipped = whole;
  flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 1);
  folder_.file("a.h5", flipped);
  EXPECT_EQ(reading(),
            "a.h5: dataset 'x': can't be read: data error detected by Fletcher32 checksum");
}

TEST_F(HostileH5, TextsOfFixedLengthAreTrimmed) {
  for (const auto& [padding, bytes] : {std::pair{H5T_STR_SPACEPAD, std::string("ab  abcd")},
                                       {H5T_STR_NULLPAD, std::string("ab\0\0abcd", 8)},
                                       {H5T_STR_NULLTERM, std::string("ab\0xabcd", 8)}}) {
    make_file([&, padding = padding, bytes = bytes](hid_t file) {
      const hid_t type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, 4);
      H5Tset_strpad(type, padding);
      const hid_t dataset = create(file, type, simple_space({2}));
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
      H5Dclose(dataset);
    });
    EXPECT_EQ(File::open(folder_ / "a.h5").dataset("x").read<std::string>(),
              (std::vector<std::string>{"ab", "abcd"}));
  }
}

TEST_F(HostileH5, BigEndianNumbersAreRead) {
  make_file([](hid_t file) {
    const hid_t dataset = create(file, H5T_IEEE_F32BE, simple_space({2}));
    const std::vector<float> values = {1.5f, -2.0f};
    H5Dwrite(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(dataset);
  });
  EXPECT_EQ(File::open(folder_ / "a.h5").dataset("x").read<double>(),
            (std::vector<double>{1.5, -2.0}));
}

}  // namespace
}  // namespace npdr::pipeline
