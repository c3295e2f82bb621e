// What is said of bad and of suspicious studies: tests/golden/config.txt.
#include "core/text.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/config/study_warnings.h"
#include "tests/golden_file.h"
#include "tests/pipeline/small_study.h"

namespace npdr::pipeline {
namespace {

TEST(Golden, Config) {
  const TempFolder folder;
  folder.file("r.h5", "");
  folder.file("x_o.csv", "a\n1\n");
  folder.file("run.csv", "t [s],theta [rad]\n");
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
      const Study study = parse_study(with_all(text, "{folder}", path), "s.toml", overrides);
      said = join(texts_of(warnings_of(study, simulator_info(study))), "\n");
    });
    return with_all(with_all(problems + said, path, "{folder}"),
                    std::filesystem::current_path().string(), "{here}");
  });
}

}  // namespace
}  // namespace npdr::pipeline
