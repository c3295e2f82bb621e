#include "pipeline/apps/verify.h"

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(Verify, RefusesOtherVersionsOfASchema) {
  const TempFolder folder;
  for (const Schema& known :
       std::vector<Schema>{kSimulationSchema, kSimulationShardSchema, kProposalSchema}) {
    Schema newer = known;
    ++newer.version;
    const Identity identity{key_document(newer), {}, {{"name", "s"}}, 1};
    ArtefactWriter(folder / "a.h5", newer, identity).finish();
    EXPECT_TRUE(says(message_of<InputError>([&] { verify(folder / "a.h5", {}); }, &folder),
                     {"a.h5: schema '" + known.name + "' " + std::to_string(newer.version),
                      "this build reads " + std::to_string(known.version),
                      "rerun stage '" + known.stage + "'"}));
  }
}

TEST(Verify, RefusesAKeyThatIsntThatOfItsDocument) {
  const TempFolder folder;
  const Identity identity{key_document(kProposalSchema), {}, {{"name", "s"}}, 1};
  ArtefactWriter writer(folder / "a.h5", kProposalSchema, identity);
  writer.file().set_attribute("key", std::string(32, '0'));
  writer.finish();
  EXPECT_TRUE(says(message_of<InputError>([&] { verify(folder / "a.h5", {}); }, &folder),
                   {"a.h5: its key isn't that of its key document"}));
}

TEST(Verify, SaysHowToCheckAPosteriorAndWhatThatCosts) {
  const TempFolder folder;
  const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
  ArtefactWriter writer(folder / "a.h5", kPosteriorSchema, identity);
  writer.add_cost({90.0, 180.0});
  writer.finish();
  EXPECT_TRUE(says(message_of<InputError>([&] { verify(folder / "a.h5", {}); }, &folder),
                   {"a.h5: a posterior, which has no rows", "add --remake STUDY",
                    "which took 90.0 s (180.", "core-seconds)"}));
}

// A simulation whose rows come, as it says, from a command.
TEST(Verify, RunsNothingThatTheFileNamesUnlessToldTo) {
  const TempFolder folder;
  const std::string command = "touch " + (folder / "ran").string() + "\ntrue";
  const Identity identity{key_document(kSimulationSchema),
                          {},
                          {{"name", "s"},
                           {"simulator", {{"command", command}, {"folder", "/"}}},
                           {"prior", nlohmann::ordered_json::array()}},
                          1};
  ArtefactWriter writer(folder / "a.h5", kSimulationSchema, identity);
  writer.file().write("theta", RowMatrix(RowMatrix::Ones(2, 1)));
  writer.file().write("x", RowMatrixF(RowMatrixF::Ones(2, 1)));
  writer.file().write("status", VectorX<std::uint8_t>(VectorX<std::uint8_t>::Zero(2)));
  writer.finish();
  const std::string message = message_of<InputError>([&] { verify(folder / "a.h5", {}); }, &folder);
  EXPECT_TRUE(
      says(message, {"a.h5: to make its rows again runs, with your rights, the command \"touch ran",
                     "\\ntrue\" in the folder", "add --run-command if you trust them"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "ran"));
}

}  // namespace
}  // namespace npdr::pipeline
