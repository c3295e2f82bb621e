#include "pipeline/apps/verify.h"

#include <functional>

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class Verify : public FolderTest {
 protected:
  // What is said of an artefact that `write` has changed.
  std::string refusal(const Schema& schema, const std::function<void(ArtefactWriter&)>& write = {},
                      const nlohmann::ordered_json& study = {{"name", "s"}}) const {
    ArtefactWriter writer(folder_ / "a.h5", schema, {key_document(schema), {}, study, 1});
    if (write) write(writer);
    writer.finish();
    return problem([&] { verify(folder_ / "a.h5", {}); });
  }
};

TEST_F(Verify, RefusesOtherVersionsOfASchema) {
  for (const Schema& known :
       std::vector<Schema>{kSimulationSchema, kSimulationShardSchema, kProposalSchema}) {
    Schema newer = known;
    ++newer.version;
    EXPECT_TRUE(says(refusal(newer),
                     {"a.h5: schema '" + known.name + "' " + std::to_string(newer.version)}));
  }
}

TEST_F(Verify, RefusesAKeyThatIsntThatOfItsDocument) {
  EXPECT_TRUE(says(refusal(kProposalSchema,
                           [](ArtefactWriter& writer) {
                             writer.file().set_attribute("key", std::string(32, '0'));
                           }),
                   {"a.h5: its key isn't that of its key document"}));
}

TEST_F(Verify, SaysHowToCheckAPosteriorAndWhatThatCosts) {
  EXPECT_TRUE(says(refusal(kPosteriorSchema,
                           [](ArtefactWriter& writer) {
                             writer.add_cost({90.0, 180.0});
                           }),
                   {"a.h5: a posterior, which has no rows", "add --remake STUDY",
                    "which took 90.0 s (180.", "core-seconds)"}));
}

// A simulation whose rows come, as it says, from a command.
TEST_F(Verify, RunsNothingThatTheFileNamesUnlessToldTo) {
  const std::string command = "touch " + (folder_ / "ran").string() + "\ntrue";
  const std::string said = refusal(
      kSimulationSchema,
      [](ArtefactWriter& writer) {
        writer.file().write("theta", RowMatrix(RowMatrix::Ones(2, 1)));
        writer.file().write("x", RowMatrixF(RowMatrixF::Ones(2, 1)));
        writer.file().write("status", VectorX<std::uint8_t>(VectorX<std::uint8_t>::Zero(2)));
      },
      {{"name", "s"},
       {"simulator", {{"command", command}, {"folder", "/"}}},
       {"prior", nlohmann::ordered_json::array()}});
  EXPECT_TRUE(
      says(said, {"a.h5: to make its rows again runs, with your rights, the command \"touch ran",
                  "\\ntrue\" in the folder", "add --run-command if you trust them"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "ran"));
}

}  // namespace
}  // namespace npdr::pipeline
