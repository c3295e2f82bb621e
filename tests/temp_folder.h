/// Files and folders that live as long as one test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/error.h"
#include "tests/message_of.h"

namespace npdr {

/// A new, empty folder; removed with all that is in it.
class TempFolder {
 public:
  TempFolder() {
    std::string name = std::filesystem::temp_directory_path() / "npdr_test_XXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    path_ = name;
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// Writes `text` to a file of the folder.
  std::filesystem::path file(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

  /// Number of files and folders in it.
  std::ptrdiff_t size() const {
    return std::distance(std::filesystem::directory_iterator(path_), {});
  }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Message of the exception of type E that `body` throws, with the folder's name cut out.
template <class E, class Body>
std::string message_of(const Body& body, const TempFolder* folder) {
  std::string message = message_of<E>(body);
  const std::string prefix = folder->path().string() + "/";
  while (message.find(prefix) != std::string::npos) {
    message.erase(message.find(prefix), prefix.size());
  }
  return message;
}

/// A test with a folder of its own.
class FolderTest : public ::testing::Test {
 protected:
  /// Message of the bad input that `body` finds, without the folder's name; "" when it finds none.
  template <class Body>
  std::string problem(const Body& body) const {
    return message_of<InputError>(body, &folder_);
  }

  TempFolder folder_;
};

}  // namespace npdr
