#include "pipeline/store/seal.h"

#include "core/error.h"
#include "pipeline/store/artefact.h"
#include "tests/file_size_limit.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const Schema kSealedSchema = {"posterior", 3, "infer"};
constexpr std::size_t kSealBytes = 47;

std::string artefact(const TempFolder& folder) {
  Identity identity;
  identity.key_document["a"] = 1;
  ArtefactWriter writer(folder / "a.h5", kSealedSchema, identity);
  writer.file().write_text("text", "a text has no checksum in HDF5");
  writer.finish();
  return text_of(folder / "a.h5");
}

std::string opening(const TempFolder& folder, const std::string& bytes) {
  folder.file("a.h5", bytes);
  return message_of<InputError>([&] { open_artefact(folder / "a.h5", kSealedSchema); }, &folder);
}

TEST(Seal, IsTheHashOfWhatComesBeforeIt) {
  const TempFolder folder;
  folder.file("a", "some bytes");
  EXPECT_FALSE(has_intact_seal(folder / "a"));
  seal_file(folder / "a", folder / "a");
  // As xxhsum -H2 prints it.
  EXPECT_EQ(text_of(folder / "a"), "some bytesnpdr xxh3-128 99736577b441a1bbd3ec197fe371e984\n");
  EXPECT_TRUE(has_intact_seal(folder / "a"));
}

TEST(Seal, FindsAChangedByteWhereHdf5HasNoChecksum) {
  const TempFolder folder;
  std::string bytes = artefact(folder);
  const std::size_t at = bytes.find("no checksum");
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'N';
  EXPECT_EQ(opening(folder, bytes), "a.h5: is damaged: its bytes don't match its checksum");
  EXPECT_EQ(h5::File::open(folder / "a.h5").read_text("text"), "a text has No checksum in HDF5")
      << "or there is no need for seals";
}

TEST(Seal, WhatLacksIsMissed) {
  const TempFolder folder;
  const std::string bytes = artefact(folder);
  const std::string gone = "a.h5: is damaged: its end with the checksum is missing";
  EXPECT_EQ(opening(folder, bytes.substr(0, bytes.size() - kSealBytes)), gone);
  EXPECT_EQ(opening(folder, bytes.substr(0, bytes.size() - 1)), gone);
  std::string other = bytes;
  other[bytes.size() - kSealBytes] = 'x';
  EXPECT_EQ(opening(folder, other), gone);
}

TEST(Seal, FilesOfEarlierVersionsHaveNone) {
  const TempFolder folder;
  h5::File file = h5::File::create(folder / "a.h5");
  file.set_attribute("schema", kSealedSchema.name);
  file.set_attribute("schema_version", kSealedSchema.version);
  file.set_attribute("key", std::string("0"));
  file.set_attribute("complete", Index{1});
  file.create_group("provenance");
  file.close();
  EXPECT_FALSE(has_intact_seal(folder / "a.h5"));
  EXPECT_EQ(open_artefact(folder / "a.h5", kSealedSchema).attribute<std::string>("key"), "0");
}

TEST(Seal, WhatCantBeReadIsForTheReaderToExplain) {
  const TempFolder folder;
  folder.file("short", "x");
  for (const auto& path : {folder / "short", folder / "missing", folder.path()}) {
    EXPECT_FALSE(has_intact_seal(path)) << path;
  }
}

TEST(Seal, AFullDiskIsAnError) {
  const TempFolder folder;
  folder.file("a", std::string(100, 'x'));
  const FileSizeLimit limit(120);
  EXPECT_TRUE(says(message_of<Error>([&] { seal_file(folder / "a", "result.h5"); }),
                   {"result.h5: can't be given its checksum: File too large",
                    "raise the limit on the size of a file (ulimit -f)"}));
}

}  // namespace
}  // namespace npdr::pipeline
