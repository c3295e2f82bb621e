#include "pipeline/store/artefact.h"

#include <hdf5.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <set>

#include "core/constants.h"
#include "core/error.h"
#include "pipeline/process/build_info.h"
#include "pipeline/store/hash.h"
#include "tests/file_size_limit.h"
#include "tests/pipeline/store/written_h5.h"
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
  writer.file().write("names", std::vector<std::string>{"a", "b"});
  h5::Dataset seconds = writer.file().create_dataset("seconds", h5::ElementType::f64, {3});
  seconds.write_rows<double>(0, 3, std::vector<double>{1.0, 2.0, static_cast<double>(::getpid())});
  seconds.set_attribute(kVolatile, Index{1});
  writer.finish();
}

class Artefact : public FolderTest {
 protected:
  Artefact() { write_artefact(path_); }

  std::string opening(const Schema& schema, const std::string& key = "") const {
    return problem([&] { open_artefact({path_, key}, schema); });
  }

  std::filesystem::path path_ = folder_ / "a.h5";
};

TEST_F(Artefact, SaysWhatItIsAndWhereItComesFrom) {
  const ArtefactInfo info = read_artefact_info(path_);
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
  EXPECT_FALSE(creator_version().empty() || git_revision().empty() || instruction_set().empty());
  EXPECT_EQ(info.provenance.host, host_name());
  EXPECT_EQ(info.provenance.created.size(), std::string("2024-03-01T12:00:00Z").size());
  EXPECT_GT(info.provenance.cost.wall_seconds, 0.0);
  const h5::File file = open_artefact({path_, identity().key()}, kSchema);
  EXPECT_EQ(file.read_matrix<double>("theta").rows(), 3);
}

TEST_F(Artefact, HoldsAStudyWhosePathsArentUtf8) {
  Identity made_from = identity();
  made_from.study["target"]["recording"] = "caf\xe9.h5";
  write_artefact(path_, 1.0, kSchema, made_from);
  EXPECT_EQ(read_artefact_info(path_).identity.study["target"]["recording"], "caf\xEF\xBF\xBD.h5");
}

TEST_F(Artefact, AnotherSchemaVersionOrKeySaysWhatToRerun) {
  write_artefact(path_, 1.0, {"posterior", 2, "infer"});
  EXPECT_TRUE(says(opening(kSchema),
                   {"a.h5: schema 'posterior' 2, this build reads 3", "rerun stage 'infer'"}));
  EXPECT_TRUE(says(opening({"simulations", 3, "simulate"}),
                   {"a.h5: schema 'posterior'", "must be 'simulations'",
                    "give an artefact of stage 'simulate'"}));
  EXPECT_TRUE(
      says(opening({"posterior", 2, "infer"}, "00"),
           {"a.h5: key " + identity().key(), "must be 00", "remove it", "rerun stage 'infer'"}));
}

TEST_F(Artefact, FilesThatArentCompleteArtefactsAreRefused) {
  written_h5(path_, [](h5::File&) {});
  EXPECT_EQ(opening(kSchema), "a.h5: isn't an artefact of this program");
  written_h5(path_, [](h5::File& file) {
    file.set_attribute("schema", std::string("posterior"));
    file.set_attribute("schema_version", Index{3});
  });
  EXPECT_TRUE(says(opening(kSchema), {"a.h5: is incomplete", "remove it and run its stage again"}));
}

TEST_F(Artefact, DoesntExistUnlessItIsFinished) {
  std::filesystem::remove(path_);
  {
    ArtefactWriter writer(path_, kSchema, identity());
    writer.file().write("theta", RowMatrix(RowMatrix::Ones(3, 2)));
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
  EXPECT_EQ(folder_.size(), 0);
}

TEST_F(Artefact, AFullDiskLeavesTheOldOne) {
  const std::string digest = content_digest(path_);
  const auto write_much = [&] {
    const FileSizeLimit limit(50'000);
    ArtefactWriter writer(path_, kSchema, identity());
    writer.file().write("theta", RowMatrix(RowMatrix::Random(300, 300)));
    writer.finish();
  };
  EXPECT_TRUE(has(message_of<Error>(write_much, &folder_), {"a.h5", "File too large"}));
  EXPECT_EQ(content_digest(path_), digest);
  EXPECT_EQ(folder_.size(), 1);
}

TEST_F(Artefact, DigestIgnoresWhoMadeItWhenAndHowItIsStored) {
  Identity other = identity();
  other.study = Json::parse(R"({"study":{"name":"the same, with another title"}})");
  ArtefactWriter writer(folder_ / "b.h5", kSchema, other);
  writer.file().write("names", std::vector<std::string>{"a", "b"});
  writer.file().write("theta", RowMatrix(RowMatrix::Ones(3, 2)), {.chunked = false});
  writer.finish();
  EXPECT_EQ(content_digest(path_), content_digest(folder_ / "b.h5"));
  write_artefact(path_, std::nextafter(1.0, 2.0));
  EXPECT_NE(content_digest(path_), content_digest(folder_ / "b.h5")) << "a flipped bit";
}

TEST(ContentDigest, DependsOnNamesShapesTypesTextsAndAttributes) {
  using Fill = std::function<void(h5::File&)>;
  const TempFolder folder;
  const auto zeros = [](const char* name, const auto& values) {
    return [=](h5::File& f) { f.write(name, values); };
  };
  const auto texts = [](const std::vector<std::string>& values) {
    return [=](h5::File& f) { f.write("a", values); };
  };
  const auto attribute = [](const auto& value) {
    return [=](h5::File& f) { f.set_attribute("a", value); };
  };
  std::set<std::string> digests;
  const std::vector<Fill> fills = {
      [](h5::File&) {},
      [](h5::File& f) { f.create_group("a"); },
      zeros("a", RowMatrix(RowMatrix::Zero(2, 3))),
      zeros("b", RowMatrix(RowMatrix::Zero(2, 3))),
      zeros("a", RowMatrix(RowMatrix::Zero(3, 2))),
      zeros("a", RowMatrixF(RowMatrixF::Zero(2, 3))),
      zeros("a", Vector(Vector::Zero(6))),
      zeros("a", VectorX<std::int64_t>(VectorX<std::int64_t>::Zero(6))),
      texts({"ab", "c"}),
      texts({"a", "bc"}),
      attribute(1.0),
      attribute(Index{1}),
      attribute(std::string("1")),
      attribute(std::vector<Index>{1, 2})};
  for (std::size_t i = 0; i < fills.size(); ++i) {
    const std::string digest = content_digest(written_h5(folder / "a.h5", fills[i]));
    EXPECT_EQ(digest.size(), 32u);
    EXPECT_TRUE(digests.insert(digest).second) << i;
  }
}

TEST(ContentDigest, ReadsLargeDatasetsInBlocks) {
  const TempFolder folder;
  RowMatrixF values = RowMatrixF::Random(3000, 1000);  // 12 MB: two blocks
  const auto digest = [&](const h5::Storage& storage) {
    return content_digest(
        written_h5(folder / "a.h5", [&](h5::File& f) { f.write("a", values, storage); }));
  };
  const std::string whole = digest({.deflate = 0});
  EXPECT_EQ(digest({.chunked = false}), whole);
  values(2999, 999) += 1.0f;
  EXPECT_NE(digest({.deflate = 0}), whole);
}

TEST(ContentDigest, RefusesAGroupThatHoldsItself) {
  const TempFolder folder;
  const auto path = written_h5(folder / "a.h5", [](h5::File& file) {
    file.create_group("g");
    H5Lcreate_hard(file.id(), "/", file.id(), "g/root", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_TRUE(has(message_of<InputError>([&] { content_digest(path); }),
                  "groups are nested 33 deep, must be <= 32"));
}

TEST(ContentKey, DependsOnTheOrderOfListsAndNotOnThatOfMembers) {
  const auto key = [](const char* text) { return content_key(Json::parse(text)); };
  EXPECT_EQ(key(R"({"stage":"infer","lr":1e-3})"), "3b129030171884c26011462a9b7ea815") << "forever";
  EXPECT_EQ(key(R"({"a":1,"b":[1,2]})"), key(R"({ "b":[1,2], "a":1 })"));
  EXPECT_NE(key(R"({"a":1,"b":[1,2]})"), key(R"({"a":1,"b":[2,1]})"));
  EXPECT_NE(key(R"({"a":1})"), key(R"({"a":1.0000000000000002})"));
  EXPECT_EQ(canonical_json(Json::parse(R"({"b":0.1,"a":"x"})")), R"({"a":"x","b":0.1})");
}

TEST(ContentKey, RefusesWhatJsonCantHold) {
  Json document;
  document["a"]["b"] = {1.0, kNaN};
  EXPECT_THROW(content_key(document), InputError);
  document["a"]["b"] = "\xff";
  EXPECT_THROW(content_key(document), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
