#include "pipeline/run/artefact_status.h"

#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/config/study_reader.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(ArtefactStatus, SaysHowFarARefinementHasCome) {
  const TempFolder folder;
  const std::string study =
      pendulum_study("refined")
          .with("observation_noise", {"scale = 0.1"})
          .method("Start", {"embedding = { kind = \"bayessim\" }", kSmallMixture})
          .method("Refined", {"algorithm = \"refine\"", "refine = { start = \"Start\" }"});
  const Plan plan = make_plan(parse_study(study, "s.toml"), WorkFolder(folder.path()));
  const Node& node = plan.node(Stage::infer, {"Refined", 1, 1});
  RefinementCheckpoint checkpoint;
  checkpoint.state.num_draws = 300;
  std::filesystem::create_directories(node.path.parent_path());
  kRefinementCheckpointSchema.write(plan.work.checkpoint("infer", node.key), node.identity,
                                    checkpoint);
  const ArtefactStatus status = status_of(plan, node, Scrutiny::thorough);
  EXPECT_EQ(status.state, ArtefactState::partial) << status.detail;
  EXPECT_EQ(status.detail, "checkpoint at simulation 300");
  EXPECT_TRUE(status.is_sound);
  EXPECT_EQ(reasons(plan, node),
            std::vector<std::string>{"it isn't finished: checkpoint at simulation 300"});
  std::filesystem::remove(plan.work.checkpoint("infer", node.key));
  EXPECT_EQ(reasons(plan, node), std::vector<std::string>{"it was never made"});
}

TEST(ArtefactStatus, OfAJobThatFailedNamesItsLog) {
  const TempFolder folder;
  const std::string study = pendulum_study("failed").method("NPE");
  const Plan plan = make_plan(parse_study(study, "s.toml"), WorkFolder(folder.path()));
  const Node& node = plan.node(Stage::infer, {"NPE", 1, 1});
  EXPECT_EQ(status_of(plan, node).detail, "");
  const std::filesystem::path log = log_of(plan, node);
  std::filesystem::create_directories(log.parent_path());
  std::ofstream(log) << "npdr-infer: no memory\n";
  const ArtefactStatus status = status_of(plan, node);
  EXPECT_EQ(status.state, ArtefactState::missing);
  EXPECT_EQ(status.detail, "what its jobs have said: " + log.string());
  EXPECT_EQ(reasons(plan, node), (std::vector<std::string>{"it was never made", status.detail}));
}

}  // namespace
}  // namespace npdr::pipeline
