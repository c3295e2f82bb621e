#include "pipeline/store/artefact.h"

#include <unistd.h>

#include "core/constants.h"
#include "core/error.h"
#include "pipeline/process/build_info.h"
#include "pipeline/store/content_key.h"
#include "tests/file_size_limit.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

const Schema kSchema = {"posterior", 3, "infer"};

Identity identity() {
  return {.key_document = Json::parse(R"({"stage":"infer","lr":1e-3})"),
          .inputs = {{"simulations", "0123"}, {"target", "abcd"}},
          .study = Json::parse(R"({"study":{"name":"s"}})"),
          .seed = 7};
}

void write_artefact(const std::filesystem::path& path, double value = 1.0,
                    const Schema& schema = kSchema, const Identity& made_from = identity()) {
  ArtefactWriter writer(path, schema, made_from);
  writer.file().write("theta", RowMatrix(RowMatrix::Constant(3, 2, value)));
  writer.file().write_texts("names", {"a", "b"});
  h5::Dataset seconds = writer.file().create_dataset("seconds", h5::ElementType::f64, {3});
  seconds.write_rows<double>(0, 3, std::vector<double>{1.0, 2.0, static_cast<double>(::getpid())});
  mark_volatile(seconds);
  writer.finish();
}

std::string opening(const TempFolder& folder, const Schema& schema, const std::string& key = "") {
  return message_of<InputError>([&] { open_artefact(folder / "a.h5", schema, key); }, &folder);
}

TEST(Artefact, SaysWhatItIsAndWhereItComesFrom) {
  const TempFolder folder;
  write_artefact(folder / "a.h5");
  const ArtefactInfo info = read_artefact_info(folder / "a.h5");
  EXPECT_EQ(info.schema.name, "posterior");
  EXPECT_EQ(info.schema.version, 3);
  EXPECT_EQ(info.schema.stage, "infer");
  EXPECT_EQ(info.key, content_key(identity().key_document));
  EXPECT_EQ(info.identity.key(), info.key) << "the document is what was hashed";
  EXPECT_EQ(info.identity.inputs, identity().inputs);
  EXPECT_EQ(info.identity.study, identity().study);
  EXPECT_EQ(info.identity.seed, 7u);
  EXPECT_EQ(info.provenance.creator_version, creator_version());
  EXPECT_EQ(info.provenance.git_revision, git_revision());
  EXPECT_EQ(info.provenance.instruction_set, instruction_set());
  EXPECT_EQ(info.provenance.host, host_name());
  EXPECT_EQ(info.provenance.created.size(), std::string("2024-03-01T12:00:00Z").size());
  EXPECT_GT(info.provenance.cost.wall_seconds, 0.0);
}

TEST(Artefact, HoldsAStudyWhosePathsArentUtf8) {
  const TempFolder folder;
  Identity made_from = identity();
  made_from.study["target"]["recording"] = "caf\xe9.h5";
  write_artefact(folder / "a.h5", 1.0, kSchema, made_from);
  EXPECT_EQ(read_artefact_info(folder / "a.h5").identity.study["target"]["recording"],
            "caf\xEF\xBF\xBD.h5");
}

TEST(Artefact, OpensWithItsSchemaAndKey) {
  const TempFolder folder;
  write_artefact(folder / "a.h5");
  const h5::File file = open_artefact(folder / "a.h5", kSchema, identity().key());
  EXPECT_EQ(file.read_matrix<double>("theta").rows(), 3);
}

TEST(Artefact, AnotherSchemaVersionOrKeySaysWhatToRerun) {
  const TempFolder folder;
  write_artefact(folder / "a.h5", 1.0, {"posterior", 2, "infer"});
  EXPECT_TRUE(says(opening(folder, kSchema),
                   {"a.h5: schema 'posterior' 2, this build reads 3", "rerun stage 'infer'"}));
  EXPECT_TRUE(says(opening(folder, {"simulations", 3, "simulate"}),
                   {"a.h5: schema 'posterior'", "must be 'simulations'",
                    "give an artefact of stage 'simulate'"}));
  EXPECT_TRUE(
      says(opening(folder, {"posterior", 2, "infer"}, "00"),
           {"a.h5: key " + identity().key(), "must be 00", "remove it", "rerun stage 'infer'"}));
}

TEST(Artefact, FilesThatArentCompleteArtefactsAreRefused) {
  const TempFolder folder;
  h5::File::create(folder / "a.h5").close();
  EXPECT_EQ(opening(folder, kSchema), "a.h5: isn't an artefact of this program");
  h5::File file = h5::File::create(folder / "a.h5");
  file.set_attribute("schema", std::string("posterior"));
  file.set_attribute("schema_version", Index{3});
  file.close();
  EXPECT_TRUE(
      says(opening(folder, kSchema), {"a.h5: is incomplete", "remove it and run its stage again"}));
}

TEST(Artefact, DoesntExistUnlessItIsFinished) {
  const TempFolder folder;
  {
    ArtefactWriter writer(folder / "a.h5", kSchema, identity());
    writer.file().write("theta", RowMatrix(RowMatrix::Ones(3, 2)));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
  }
  EXPECT_EQ(folder.size(), 0);
}

TEST(Artefact, AFullDiskLeavesTheOldOne) {
  const TempFolder folder;
  write_artefact(folder / "a.h5");
  const std::string digest = content_digest(folder / "a.h5");
  {
    const FileSizeLimit limit(50'000);
    const std::string message = message_of<Error>(
        [&] {
          ArtefactWriter writer(folder / "a.h5", kSchema, identity());
          writer.file().write("theta", RowMatrix(RowMatrix::Random(300, 300)));
          writer.finish();
        },
        &folder);
    EXPECT_TRUE(has(message, {"a.h5", "File too large"}));
  }
  EXPECT_EQ(content_digest(folder / "a.h5"), digest);
  EXPECT_EQ(folder.size(), 1);
}

TEST(ContentDigest, IgnoresWhoMadeItWhenAndHowItIsStored) {
  const TempFolder folder;
  write_artefact(folder / "a.h5");
  Identity other = identity();
  other.study = Json::parse(R"({"study":{"name":"the same, with another title"}})");
  ArtefactWriter writer(folder / "b.h5", kSchema, other);
  writer.file().write_texts("names", {"a", "b"});
  writer.file().write("theta", RowMatrix(RowMatrix::Ones(3, 2)), {.chunked = false});
  writer.finish();
  EXPECT_EQ(content_digest(folder / "a.h5"), content_digest(folder / "b.h5"));
}

TEST(ContentDigest, CatchesAFlippedBit) {
  const TempFolder folder;
  write_artefact(folder / "a.h5", 1.0);
  write_artefact(folder / "b.h5", std::nextafter(1.0, 2.0));
  EXPECT_NE(content_digest(folder / "a.h5"), content_digest(folder / "b.h5"));
}

TEST(ContentDigest, DependsOnNamesShapesTypesTextsAndAttributes) {
  const TempFolder folder;
  const auto digest = [&](const auto& fill) {
    h5::File file = h5::File::create(folder / "a.h5");
    fill(file);
    file.close();
    return content_digest(folder / "a.h5");
  };
  const auto zeros = [](const char* name, Index rows, Index cols) {
    return [=](h5::File& file) { file.write(name, RowMatrix(RowMatrix::Zero(rows, cols))); };
  };
  const std::vector<std::string> digests = {
      digest([](h5::File&) {}),
      digest(zeros("a", 2, 3)),
      digest(zeros("b", 2, 3)),
      digest(zeros("a", 3, 2)),
      digest([](h5::File& f) { f.write("a", RowMatrixF(RowMatrixF::Zero(2, 3))); }),
      digest([](h5::File& f) { f.write("a", Vector(Vector::Zero(6))); }),
      digest(
          [](h5::File& f) { f.write("a", VectorX<std::int64_t>(VectorX<std::int64_t>::Zero(6))); }),
      digest([](h5::File& f) { f.create_group("a"); }),
      digest([](h5::File& f) {
        f.write_texts("a", {"ab", "c"});
      }),
      digest([](h5::File& f) {
        f.write_texts("a", {"a", "bc"});
      }),
      digest([](h5::File& f) { f.set_attribute("a", 1.0); }),
      digest([](h5::File& f) { f.set_attribute("a", Index{1}); }),
      digest([](h5::File& f) { f.set_attribute("a", std::string("1")); }),
      digest([](h5::File& f) {
        f.set_attribute("a", std::vector<Index>{1, 2});
      }),
  };
  for (std::size_t i = 0; i < digests.size(); ++i) {
    EXPECT_EQ(digests[i].size(), 32u);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(digests[i], digests[j]) << i << " and " << j;
  }
}

TEST(ContentDigest, ReadsLargeDatasetsInBlocks) {
  const TempFolder folder;
  RowMatrixF values = RowMatrixF::Random(3000, 1000);  // 12 MB: two blocks
  const auto digest = [&](const h5::Storage& storage) {
    h5::File file = h5::File::create(folder / "a.h5");
    file.write("a", values, storage);
    file.close();
    return content_digest(folder / "a.h5");
  };
  const std::string whole = digest({.deflate = 0});
  EXPECT_EQ(digest({.deflate = 0, .rows_per_chunk = 7}), whole);
  values(2999, 999) += 1.0f;
  EXPECT_NE(digest({.deflate = 0}), whole);
}

TEST(ContentKey, DependsOnTheOrderOfListsAndNotOnThatOfMembers) {
  const auto key = [](const char* text) { return content_key(Json::parse(text)); };
  EXPECT_EQ(key(R"({"a":1,"b":[1,2]})"), key(R"({ "b":[1,2], "a":1 })"));
  EXPECT_NE(key(R"({"a":1,"b":[1,2]})"), key(R"({"a":1,"b":[2,1]})"));
  EXPECT_NE(key(R"({"a":1})"), key(R"({"a":1.0000000000000002})"));
  EXPECT_EQ(canonical_json(Json::parse(R"({"b":0.1,"a":"x"})")), R"({"a":"x","b":0.1})");
}

TEST(ContentKey, IsTheSameForever) {
  EXPECT_EQ(content_key(Json::parse(R"({"stage":"infer","lr":1e-3})")),
            "3b129030171884c26011462a9b7ea815");
}

TEST(ContentKey, RefusesWhatJsonCantHold) {
  Json document;
  document["a"]["b"] = {1.0, kNaN};
  EXPECT_THROW(content_key(document), InputError);
  document["a"]["b"] = "\xff";
  EXPECT_THROW(content_key(document), InputError);
}

TEST(BuildInfo, NamesTheBuild) {
  EXPECT_FALSE(creator_version().empty());
  EXPECT_FALSE(git_revision().empty());
  EXPECT_FALSE(instruction_set().empty());
}

}  // namespace
}  // namespace npdr::pipeline
