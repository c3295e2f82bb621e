#include "pipeline/apps/verify.h"

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(Verify, RefusesOtherVersionsOfASchema) {
  const TempFolder folder;
  for (const Schema& known : {kSimulationSchema, kSimulationShardSchema, kProposalSchema}) {
    Schema newer = known;
    ++newer.version;
    const Identity identity{key_document(newer), {}, {{"name", "s"}}, 1};
    ArtefactWriter(folder / "a.h5", newer, identity).finish();
    EXPECT_TRUE(says(message_of<InputError>([&] { verify(folder / "a.h5", 1, 0); }, &folder),
                     {"a.h5: schema '" + known.name + "' " + std::to_string(newer.version),
                      "this build reads " + std::to_string(known.version),
                      "rerun stage '" + known.stage + "'"}));
  }
}

}  // namespace
}  // namespace npdr::pipeline
