// What is said of bad and of suspicious studies: tests/golden/config.txt.
#include "core/text.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/config/study_check.h"
#include "pipeline/plan/plan.h"
#include "tests/golden_file.h"
#include "tests/pipeline/small_study.h"
#include "tests/pipeline/standing_recording.h"

namespace npdr::pipeline {
namespace {

TEST(Golden, Config) {
  const TempFolder folder;
  folder.file("r.h5", "");
  folder.file("x_o.csv", "a\n1\n");
  folder.file("run.csv", "t [s],theta [rad]\n");
  folder.file("peak.csv", "peak [m],mean\n1,2\n");
  folder.file("sim.sh", "exit 0");
  write_standing(folder / "standing.h5");
  write_standing(folder / "one_step.h5", 2, 1);
  import_dataset(folder.file("theta.csv", "b,a\n1,2\n3,4\n"), folder.file("x.csv", "1,2\n3,4\n"),
                 folder / "d.h5");
  const std::string path = folder.path().string();
  expect_golden("config", [&](const GoldenCase& given) {
    std::string text = given.text;
    std::vector<std::string> overrides;
    for (const std::string& line : given.input) {
      if (line.starts_with("--set ")) {
        overrides.push_back(with_all(with_all(line.substr(6), "{folder}", path), "\\n", "\n"));
      } else if (line != "as it is") {
        text = edited(text, line);
      }
    }
    std::string said;
    const std::string problems = message_of<InputError>([&] {
      Study study = parse_study(with_all(text, "{folder}", path), "s.toml", overrides);
      if (given.name.ends_with("(planned)")) {
        study = make_plan(study, WorkFolder(folder / "runs")).study;
      }
      said = join(texts_of(warnings_of(study, simulator_info(study))), "\n");
    });
    return with_all(with_all(problems + said, path, "{folder}"),
                    std::filesystem::current_path().string(), "{here}");
  });
}

}  // namespace
}  // namespace npdr::pipeline
