// What is said of the rows that programs simulate: tests/golden/simulate.txt.
#include "tests/cli/program.h"
#include "tests/golden_file.h"

namespace npdr::pipeline {
namespace {

// `text` with all that stands between these two replaced by `to`.
std::string with_between(std::string text, const std::string& begin, const std::string& end,
                         const std::string& to) {
  for (std::size_t at = 0; (at = text.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    const std::size_t length = text.find(end, at) - at;
    if (length < text.size()) text.replace(at, length, to);
  }
  return text;
}

// What isn't the same in every run.
std::string made_alike(std::string text, const TempFolder& folder) {
  text = with_all(text, folder.path().string(), "{folder}");
  text = with_all(text, std::filesystem::temp_directory_path().string() + "/.npdr-call.",
                  "/tmp/.npdr-call.");
  text = with_between(text, "/tmp/.npdr-call.", ".tmp/", "{call}");
  text = with_between(text, " after ", " s\n", "{time}");
  const std::string folder_of_keys = "cache/simulate/";
  for (std::size_t at = 0; (at = text.find(folder_of_keys, at)) != std::string::npos;) {
    text.replace(at += folder_of_keys.size(), 32, "{key}");
  }
  const std::size_t progress = text.find("small: 100 %");
  if (progress != std::string::npos) text.erase(progress);
  return text.substr(0, text.find_last_not_of('\n') + 1);
}

TEST(Golden, Simulate) {
  expect_golden("simulate", [](const GoldenCase& given) {
    const TempFolder folder;
    folder.file("s.toml", given.text);
    folder.file("x_o.csv", "0.5\n");
    folder.file("sim.awk", "NR > 1 { " + given.input.front() + " }\n");
    std::vector<std::string> words = {"npdr", "run", "s.toml", "--until", "simulate"};
    for (std::size_t i = 1; i < given.input.size(); ++i) {
      words.insert(words.end(), {"--set", given.input[i].substr(std::string("--set ").size())});
    }
    const Outcome outcome = run(folder.path(), words);
    const std::string said = made_alike(outcome.err, folder);
    return outcome.status == 0 ? said
                               : "exit status " + std::to_string(outcome.status) + "\n" + said;
  });
}

}  // namespace
}  // namespace npdr::pipeline
