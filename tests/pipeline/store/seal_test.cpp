// What keeps damaged and hostile files out.

#include "pipeline/store/seal.h"

#include "core/error.h"
#include "pipeline/store/artefact.h"
#include "pipeline/store/hostile_json.h"
#include "tests/file_size_limit.h"
#include "tests/pipeline/store/written_h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const Schema kSealedSchema = {"posterior", 3, "infer"};
constexpr std::size_t kSealBytes = 47;

class Seal : public FolderTest {
 protected:
  // The bytes of an artefact.
  std::string artefact() const {
    Identity identity;
    identity.key_document["a"] = 1;
    ArtefactWriter writer(folder_ / "a.h5", kSealedSchema, identity);
    writer.file().write("text", std::vector<std::string>{"a text has no checksum in HDF5"});
    writer.finish();
    return text_of(folder_ / "a.h5");
  }
  std::string opening(const std::string& bytes) const {
    folder_.file("a.h5", bytes);
    return problem([&] { open_artefact(folder_ / "a.h5", kSealedSchema); });
  }
};

TEST_F(Seal, IsTheHashOfWhatComesBeforeIt) {
  folder_.file("a", "some bytes");
  EXPECT_FALSE(has_intact_seal(folder_ / "a"));
  seal_file(folder_ / "a", folder_ / "a");
  // As xxhsum -H2 prints it.
  EXPECT_EQ(text_of(folder_ / "a"), "some bytesnpdr xxh3-128 99736577b441a1bbd3ec197fe371e984\n");
  EXPECT_TRUE(has_intact_seal(folder_ / "a"));
  for (const auto& path : {folder_.file("short", "x"), folder_ / "missing", folder_.path()}) {
    EXPECT_FALSE(has_intact_seal(path)) << path << ": for the reader to explain";
  }
}

TEST_F(Seal, FindsAChangedByteWhereHdf5HasNoChecksum) {
  std::string bytes = artefact();
  const std::size_t at = bytes.find("no checksum");
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'N';
  EXPECT_EQ(opening(bytes), "a.h5: is damaged: its bytes don't match its checksum");
  EXPECT_EQ(h5::File::open(folder_ / "a.h5").dataset("text").read<std::string>().front(),
            "a text has No checksum in HDF5")
      << "or there is no need for seals";
}

TEST_F(Seal, WhatLacksIsMissed) {
  const std::string bytes = artefact();
  std::string other = bytes;
  other[bytes.size() - kSealBytes] = 'x';
  for (const std::string& damaged :
       {bytes.substr(0, bytes.size() - kSealBytes), bytes.substr(0, bytes.size() - 1), other}) {
    EXPECT_EQ(opening(damaged), "a.h5: is damaged: its end with the checksum is missing");
  }
}

TEST_F(Seal, FilesOfEarlierVersionsHaveNone) {
  const auto path = written_h5(folder_ / "a.h5", [](h5::File& file) {
    file.set_attribute("schema", kSealedSchema.name);
    file.set_attribute("schema_version", kSealedSchema.version);
    file.set_attribute("key", std::string("0"));
    file.set_attribute("complete", Index{1});
    file.create_group("provenance");
  });
  EXPECT_FALSE(has_intact_seal(path));
  EXPECT_EQ(open_artefact(path, kSealedSchema).attribute<std::string>("key"), "0");
}

TEST_F(Seal, AFullDiskIsAnError) {
  folder_.file("a", std::string(100, 'x'));
  const FileSizeLimit limit(120);
  EXPECT_TRUE(has(message_of<Error>([&] { seal_file(folder_ / "a", "result.h5"); }),
                  "result.h5: can't be given its checksum: File too large"));
}

std::string refusal_of(const std::string& text) {
  return message_of<InputError>([&] { parse_json(text, "a.h5"); });
}

TEST(HostileJson, ThatWouldEndTheProcessOrIsNoneIsRefused) {
  const std::string nested(100'000, '[');
  EXPECT_TRUE(says(refusal_of(nested), {"a.h5: its JSON nests too deeply"}));
  EXPECT_TRUE(says(refusal_of("{'a'}"), {"a.h5: ", "{'a'}", "isn't JSON"}));
  const auto nested_by = [](int depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_TRUE(json_in(nested_by(500)));
  for (const std::string& bad : {nested, nested_by(501), std::string("{'a'}")}) {
    EXPECT_FALSE(json_in(bad));
  }
  const std::string of_brackets = R"(["\"\\)" + std::string(1000, '[') + "\"]";
  EXPECT_EQ(parse_json(of_brackets, "a.h5").size(), 1u);
}

}  // namespace
}  // namespace npdr::pipeline
