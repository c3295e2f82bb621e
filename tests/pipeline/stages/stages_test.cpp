#include "pipeline/stages/stages.h"

#include "pipeline/config/study_reader.h"
#include "tests/pipeline/study_text.h"
#include "tests/pipeline/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(Stages, AMissingInputNamesTheProgramThatMakesIt) {
  const TempFolder folder;
  const Plan plan =
      make_plan(parse_study(kStudyText, "s.toml", {"study.seeds=[1]"}), WorkFolder(folder.path()));
  const auto message = [&](const Node& node) {
    return message_of<InputError>([&] { require_inputs(plan, node); });
  };
  EXPECT_EQ(message(plan.node(Stage::baseline, {})),
            "baseline needs 'target', which isn't there; run npdr-propose on this study first, or "
            "npdr run");
  EXPECT_EQ(message(plan.node(Stage::report, {})),
            "report needs 'baseline', which isn't there; run npdr-evaluate on this study first, or "
            "npdr run");
}

}  // namespace
}  // namespace npdr::pipeline
