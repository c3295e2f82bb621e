// Files that lie about what they hold. Only HDF5 itself can make them.
#include <hdf5.h>
#include <sys/stat.h>

#include "pipeline/store/h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using h5::File;

// A file with one dataset 'x', made by `make`, which gets the file's identifier.
template <class Make>
void make_file(const std::filesystem::path& path, const Make& make) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  make(file);
  ASSERT_GE(H5Fclose(file), 0);
}

hid_t create(hid_t file, hid_t type, hid_t space, hid_t properties = H5P_DEFAULT) {
  return H5Dcreate2(file, "x", type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
}

hid_t simple_space(std::vector<hsize_t> extents) {
  return H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
}

class HostileH5 : public ::testing::Test {
 protected:
  std::string reading(const std::string& name = "a.h5") const {
    return message_of<InputError>([&] { File::open(folder_ / name).dataset("x").read<double>(); },
                                  &folder_);
  }

  TempFolder folder_;
};

TEST_F(HostileH5, ClaimsOfMoreThanTheFileHoldsAreRefusedBeforeAnythingIsAllocated) {
  make_file(folder_ / "a.h5", [](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 1000;
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 9);
    const hid_t dataset =
        create(file, H5T_IEEE_F64LE, simple_space({1'000'000'000'000}), properties);
    const std::vector<double> values(1000, 1.0);
    const hid_t all = H5Dget_space(dataset), memory = simple_space({1000});
    const hsize_t begin = 0;
    H5Sselect_hyperslab(all, H5S_SELECT_SET, &begin, nullptr, &chunk, nullptr);
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory, all, H5P_DEFAULT, values.data());
    H5Dclose(dataset);
  });
  const std::string message = reading();
  EXPECT_TRUE(
      message.starts_with("a.h5: dataset 'x' claims shape (1000000000000) (8000000000000 "
                          "bytes), but the file holds only "))
      << message;
}

TEST_F(HostileH5, AFilterThatIsntHereIsNamed) {
  make_file(folder_ / "a.h5", [](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 2, begin = 0;
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_filter(properties, 32000, H5Z_FLAG_OPTIONAL, 0, nullptr);  // h5py's lzf
    const hid_t dataset = create(file, H5T_IEEE_F64LE, simple_space({2}), properties);
    const double values[] = {1.0, 2.0};
    H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &begin, sizeof values, values);
    H5Dclose(dataset);
  });
  EXPECT_TRUE(says(reading(), {"a.h5: dataset 'x': is compressed by '32000'",
                               "write it with gzip, or as it is"}));
}

TEST_F(HostileH5, ADatasetThatWasNeverWrittenIsRefused) {
  make_file(folder_ / "a.h5", [](hid_t file) {
    H5Dclose(create(file, H5T_IEEE_F64LE, simple_space({4, 1'000'000'000})));
  });
  EXPECT_TRUE(says(reading(), {"a.h5: dataset 'x' claims shape (4, 1000000000)",
                               "nothing was ever written to it"}));
}

TEST_F(HostileH5, SizesThatOverflowAreRefused) {
  make_file(folder_ / "a.h5", [](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const std::vector<hsize_t> chunk = {1, 1};
    H5Pset_chunk(properties, 2, chunk.data());
    H5Dclose(create(file, H5T_IEEE_F64LE, simple_space({1ull << 40, 1ull << 20}), properties));
  });
  EXPECT_EQ(reading(), "a.h5: dataset 'x': claims an impossible number of values");
}

TEST_F(HostileH5, OtherTypesAreNamed) {
  struct Record {
    double a, b;
  };
  const auto with_type = [&](hid_t type) {
    make_file(folder_ / "a.h5", [&](hid_t file) {
      const hid_t dataset = create(file, type, simple_space({2}));
      const std::vector<char> zeros(2 * H5Tget_size(type));
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data());
      H5Dclose(dataset);
    });
    return reading();
  };
  const hid_t record = H5Tcreate(H5T_COMPOUND, sizeof(Record));
  H5Tinsert(record, "a", 0, H5T_NATIVE_DOUBLE);
  const std::string must = ", must hold 64-bit floats";
  EXPECT_EQ(with_type(record), "a.h5: dataset 'x' holds compound records" + must);
  EXPECT_EQ(with_type(H5T_NATIVE_LDOUBLE), "a.h5: dataset 'x' holds 128-bit floats" + must);
  EXPECT_EQ(with_type(H5T_C_S1), "a.h5: dataset 'x' holds texts" + must);
  EXPECT_EQ(with_type(H5Tcreate(H5T_OPAQUE, 4)),
            "a.h5: dataset 'x' holds values of another type" + must);
  const hid_t boolean = H5Tenum_create(H5T_NATIVE_INT8);
  const std::int8_t zero = 0;
  H5Tenum_insert(boolean, "FALSE", &zero);
  EXPECT_EQ(with_type(boolean), "a.h5: dataset 'x' holds enumerated values" + must);
}

TEST_F(HostileH5, ADatasetWithoutAnArrayIsRefused) {
  make_file(folder_ / "a.h5",
            [](hid_t file) { H5Dclose(create(file, H5T_IEEE_F64LE, H5Screate(H5S_NULL))); });
  EXPECT_EQ(reading(), "a.h5: dataset 'x': holds no array");
}

TEST_F(HostileH5, ALinkToNowhereIsMissing) {
  make_file(folder_ / "a.h5",
            [](hid_t file) { H5Lcreate_soft("/nowhere", file, "x", H5P_DEFAULT, H5P_DEFAULT); });
  EXPECT_TRUE(reading().starts_with("a.h5: 'x' is a link that leads nowhere in this file"));
}

TEST_F(HostileH5, BytesOfAnotherFileAreNotRead) {
  folder_.file("secret", std::string(16, 's'));
  make_file(folder_ / "a.h5", [&](hid_t file) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(properties, (folder_ / "secret").c_str(), 0, 16);
    H5Dclose(create(file, H5T_IEEE_F64LE, simple_space({2}), properties));
  });
  EXPECT_EQ(reading(),
            "a.h5: dataset 'x': its values are bytes of other files, must be in this one");
}

TEST_F(HostileH5, ALinkToAnotherFileIsNotFollowed) {
  File other = File::create(folder_ / "other.h5");
  other.write("x", Vector(Vector::Ones(2)));
  other.close();
  make_file(folder_ / "a.h5", [](hid_t file) {
    H5Lcreate_external("other.h5", "/x", file, "x", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_TRUE(reading().starts_with("a.h5: has no dataset 'x'")) << reading();
}

TEST_F(HostileH5, RowsOfAFileInAnotherFolderAreNotRead) {
  std::filesystem::create_directory(folder_ / "folder");
  File other = File::create(folder_ / "other.h5");
  other.write("x", RowMatrix(RowMatrix::Ones(2, 3)));
  other.close();
  for (const std::string& part : {std::string("../other.h5"), (folder_ / "other.h5").string()}) {
    File file = File::create(folder_ / (part == "../other.h5" ? "folder/a.h5" : "folder/b.h5"));
    EXPECT_TRUE(
        has(message_of<InputError>([&] {
              file.create_virtual_dataset("x", h5::ElementType::f64, {2, 3}, {{part, "x", 2}});
            }),
            "isn't in the folder of this file, or below it"));
  }
}

TEST_F(HostileH5, APipeIsNotWaitedFor) {
  ASSERT_EQ(mkfifo((folder_ / "a.h5").c_str(), 0600), 0);
  EXPECT_EQ(reading(), "a.h5: isn't a regular file, must be an HDF5 file");
}

TEST_F(HostileH5, TruncatedFilesAreRefused) {
  File file = File::create(folder_ / "a.h5");
  file.write("x", Vector(Vector::Random(10'000)));
  file.close();
  const std::string whole = text_of(folder_ / "a.h5");
  for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t{600}}) {
    folder_.file("b.h5", whole.substr(0, size));
    const std::string message = reading("b.h5");
    EXPECT_TRUE(message.starts_with("b.h5: can't be opened: truncated file")) << message;
  }
}

TEST_F(HostileH5, AFlippedBitIsFound) {
  File file = File::create(folder_ / "a.h5");
  file.write("x", Vector(Vector::Random(10'000)));
  file.close();
  std::string bytes = text_of(folder_ / "a.h5");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  folder_.file("b.h5", bytes);
  EXPECT_EQ(reading("b.h5"),
            "b.h5: dataset 'x': can't be read: data error detected by Fletcher32 checksum");
}

TEST_F(HostileH5, TextsOfFixedLengthAreTrimmed) {
  const auto with_padding = [&](H5T_str_t padding, const std::string& bytes) {
    make_file(folder_ / "a.h5", [&](hid_t file) {
      const hid_t type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, 4);
      H5Tset_strpad(type, padding);
      const hid_t dataset = create(file, type, simple_space({2}));
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
      H5Dclose(dataset);
    });
    return File::open(folder_ / "a.h5").read_texts("x");
  };
  const std::vector<std::string> expected = {"ab", "abcd"};
  EXPECT_EQ(with_padding(H5T_STR_SPACEPAD, "ab  abcd"), expected);
  EXPECT_EQ(with_padding(H5T_STR_NULLPAD, std::string("ab\0\0abcd", 8)), expected);
  EXPECT_EQ(with_padding(H5T_STR_NULLTERM, std::string("ab\0xabcd", 8)),
            (std::vector<std::string>{"ab", "abcd"}));
}

TEST_F(HostileH5, BigEndianNumbersAreRead) {
  make_file(folder_ / "a.h5", [](hid_t file) {
    const hid_t dataset = create(file, H5T_IEEE_F32BE, simple_space({2}));
    const std::vector<float> values = {1.5f, -2.0f};
    H5Dwrite(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(dataset);
  });
  EXPECT_EQ(File::open(folder_ / "a.h5").read_vector<double>("x"), Vector({{1.5, -2.0}}));
}

}  // namespace
}  // namespace npdr::pipeline
