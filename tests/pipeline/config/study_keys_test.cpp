#include "pipeline/config/study_keys.h"

#include "pipeline/config/study_json.h"
#include "pipeline/config/study_template.h"
#include "tests/document_tables.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

TEST(StudyKeys, SayTypeDefaultAndWhatIsAllowed) {
  std::map<std::string, StudyKey> keys;
  for (const StudyKey& key : study_keys()) {
    EXPECT_FALSE(key.doc.empty()) << key.path;
    EXPECT_FALSE(key.type.empty()) << key.path;
    EXPECT_TRUE(keys.emplace(key.path, key).second) << key.path << " occurs twice";
  }
  EXPECT_EQ(keys.at("study.name").default_value, "required");
  EXPECT_EQ(keys.at("target.recording").default_value, "");
  const StudyKey& rate = keys.at("method.training.learning_rate");
  EXPECT_EQ(rate.type, "a finite number");
  EXPECT_EQ(rate.default_value, "0.001");
  EXPECT_EQ(rate.allowed, "> 0 and <= 1");
  EXPECT_EQ(rate.doc, "step size of Adam");
}

TEST(StudyKeys, OfATableThatThereIsntAreAnError) {
  EXPECT_EQ(message_of<InputError>([] { keys_markdown("method.trainning"); }).substr(0, 66),
            "unknown table 'method.trainning' (did you mean 'method.training'?)");
}

TEST(StudyKeys, AreThoseOfTheDocument) {
  const std::string hint = "docs/study-files.md: run scripts/docs";
  const std::string text =
      text_of(std::filesystem::path(NPDR_SOURCE_DIR) / "docs" / "study-files.md");
  for (const auto& [table, found] : document_tables(text, "keys")) {
    EXPECT_EQ(found, keys_markdown(table)) << hint;
  }
  for (const StudyKey& key : study_keys()) {
    if (key.path == "prior") continue;  // has words of its own
    // Tables that are alike, such as the stages of [cluster], are there once.
    std::istringstream rows(keys_markdown(key.path.substr(0, key.path.rfind('.'))));
    for (std::string row; std::getline(rows, row);) {
      EXPECT_TRUE(has(text, row + "\n"))
          << key.path << " has no row: add \"<!-- keys: TABLE -->\" to " << hint;
    }
  }
}

TEST(StudyTemplate, IsAValidStudyThatExplainsEveryKey) {
  const std::string text = study_template("my_study");
  EXPECT_EQ(problems_of(text), "");
  EXPECT_EQ(parse_study(text, "s.toml").name, "my_study");
  for (const StudyKey& key : study_keys()) {
    const std::string name = key.path.substr(key.path.rfind('.') + 1);
    const bool explained = text.find("\n" + name + " = ") != std::string::npos ||
                           text.find("# " + name + " = ") != std::string::npos ||
                           text.find("#   " + name + " = ") != std::string::npos ||
                           text.find("\n[" + name + "]") != std::string::npos;
    EXPECT_TRUE(explained) << key.path;
  }
}

// "# key = value" becomes "key = value".
std::string with_defaults_spelled_out(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool is_default = line.starts_with("# ") && line.find(" = ") != std::string::npos &&
                            line.find(" = ") == line.find(' ', 2) &&
                            !line.starts_with("# published");
    result += (is_default ? line.substr(2) : line) + "\n";
  }
  return result;
}

TEST(StudyTemplate, ShowsTheTrueDefaults) {
  const std::string text = study_template("a");
  const std::string spelled_out = with_defaults_spelled_out(text);
  EXPECT_NE(spelled_out, text);
  Json expected = to_json(parse_study(text, "s.toml"));
  expected["simulator"]["parameters"]["gravity"] = 9.81;  // an example: its default is empty
  EXPECT_EQ(to_json(parse_study(spelled_out, "s.toml")), expected);
}

}  // namespace
}  // namespace npdr::pipeline
