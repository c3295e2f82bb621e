
#include "pipeline/config/study_json.h"

#include <algorithm>
#include <tuple>

#include "pipeline/config/study_keys.h"
#include "pipeline/store/hostile_json.h"
#include "tests/document_tables.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

TEST(StudyJson, WritesThePriorInOrderWithUnits) {
  EXPECT_EQ(to_json(parse_study(kStudyText, "s.toml"))["prior"].dump(),
            R"([{"name":"pole_mass","unit":"kg","uniform":[0.3,1.7]},)"
            R"({"name":"pole_length","unit":"m","log_uniform":[0.3,1.7]}])");
}

TEST(StudyJson, ReadsEveryKindOfPriorBack) {
  const Study study = parse_study(kStudyText, "s.toml",
                                  {"prior.gravity={ normal = [9.81, 0.123456789012345678] }",
                                   "prior.damping={ lognormal = [-3.0, 0.5] }"});
  EXPECT_EQ(study.prior[3].kind, inference::Marginal::Kind::log_normal) << "other spelling";
  const auto parts = [](const inference::Marginal& m) {
    return std::tuple(m.name, m.unit, m.kind, m.a, m.b);
  };
  const auto prior = prior_from_json(to_json(study)["prior"], "p.h5");
  EXPECT_TRUE(std::ranges::equal(prior, study.prior, {}, parts, parts)) << "to the bit";
}

TEST(StudyJson, PhysicalEndsArePartOfDocumentsButNotOfKeys) {
  const std::string uniform = "prior.pole_mass={ uniform = [0.3, 1.7]";
  const Study plain = parse_study(kStudyText, "s.toml", {uniform + " }"}),
              physical = parse_study(kStudyText, "s.toml", {uniform + ", physical = 'lower' }"});
  EXPECT_EQ(to_json(physical.prior), to_json(plain.prior));
  const Json document = document_json(physical)["prior"];
  EXPECT_NE(document, document_json(plain)["prior"]);
  EXPECT_EQ(prior_from_json(document, "p.h5").front().physical, inference::PhysicalEnds::lower);
}

template <class Config>
void expect_round_trip(const Config& config) {
  const Json json = to_json(config);
  const Json again = Json::parse(json.dump());
  EXPECT_EQ(to_json(from_json<Config>(again, "p.h5")), json);
}

TEST(StudyJson, ConfigsSurviveARoundTrip) {
  const Study study =
      parse_study(kStudyText, "s.toml",
                  {"method.embedding={kind='bayessim', channels=['theta'], downsample=4}",
                   "method.density_estimator={kind='mdn', num_components=3}",
                   "simulator.parameters.gravity=9.8",
                   "method.training={learning_rate=1e-3, batch_size=7, validation_fraction=0.1}",
                   "method.num_atoms=3", "method.loss=atomic"});
  expect_round_trip(study.simulator);
  const MethodConfig& method = study.methods.front();
  expect_round_trip(method.embedding);
  expect_round_trip(method.density_estimator);
  expect_round_trip(method.training);
  expect_round_trip(method.algorithm);
  EXPECT_EQ(from_json<inference::TrainingConfig>(Json::object(), "").batch_size, 50)
      << "a missing key keeps its default";
}

template <class Config>
std::string problem_of(const std::string& json) {
  return message_of<InputError>([&] { from_json<Config>(parse_json(json, "p.h5"), "p.h5"); });
}

TEST(StudyJson, SaysWhatItCantAccept) {
  using inference::EmbeddingConfig;
  const std::string size = "must be an integer, >= 1 and <= 10^9";
  const std::vector<std::pair<std::string, std::string>> trainings = {
      {R"({"batch_sise": 3})", "unknown key 'batch_sise'"},
      {R"({"batch_size": 3.5})", "batch_size = 3.5, " + size},
      {R"({"batch_size": 18446744073709551615})", "batch_size = 18446744073709551615, " + size},
      {R"({"learning_rate": 0})", "learning_rate = 0, must be > 0 and <= 1"},
      {R"({"learning_rate": null})",
       "learning_rate = null, must be a finite number, > 0 and <= 1"}};
  for (const auto& [json, said] : trainings) {
    EXPECT_TRUE(says(problem_of<inference::TrainingConfig>(json), {"p.h5: " + said}));
  }
  const std::vector<std::pair<std::string, std::string>> embeddings = {
      {R"({"channels": [1]})", "channels = [1], must be a list of texts"},
      {R"({"kind": "line"})", "kind = \"line\", must be one of convolution, linear, all_steps"},
      {"[]", "must be a JSON object"},
      {"{", "'{' isn't JSON"}};
  for (const auto& [json, said] : embeddings) {
    EXPECT_TRUE(says(problem_of<EmbeddingConfig>(json), {"p.h5: " + said}));
  }
  EXPECT_EQ(problem_of<sim::SimulatorConfig>(R"({"parameters": {"a": {"b": 1}, "c": 2}})"),
            "p.h5: parameters.a = {\"b\":1}, must be a finite number");
}

TEST(StudyJson, SaysWhenAPriorIsntOne) {
  for (const char* text : {"{}", R"([{"name":"a"}])", R"([{"name":"a","unit":"m","uniform":[1]}])",
                           R"([{"name":"a","unit":"m","other":[1,2]}])", "[3]",
                           R"([{"name":1,"unit":"m","uniform":[1,2]}])"}) {
    EXPECT_TRUE(says(message_of<InputError>([&] { prior_from_json(parse_json(text, ""), "p.h5"); }),
                     {"p.h5: prior = " + parse_json(text, "").dump(),
                      R"(must be a list of {"name", "unit", "uniform": [low, high]})"}));
  }
}

TEST(StudyKeys, SayTypeDefaultAndWhatIsAllowed) {
  std::map<std::string, Field> keys;
  for (const Field& key : study_keys()) {
    EXPECT_FALSE(key.doc.empty()) << key.path;
    EXPECT_FALSE(key.type.empty()) << key.path;
    EXPECT_TRUE(keys.emplace(key.path, key).second) << key.path << " occurs twice";
  }
  EXPECT_EQ(default_text(keys.at("study.name")), "required");
  EXPECT_EQ(default_text(keys.at("target.recording")), "");
  const Field& rate = keys.at("method.training.learning_rate");
  EXPECT_EQ(rate.type, "a finite number");
  EXPECT_EQ(default_text(rate), "0.001");
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
  for (const Field& key : study_keys()) {
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
  for (const Field& key : study_keys()) {
    const bool explained = has(text, "\n" + key.key + " = ") || has(text, "# " + key.key + " = ") ||
                           has(text, "#   " + key.key + " = ") || has(text, "\n[" + key.key + "]");
    EXPECT_TRUE(explained) << key.path;
  }
}

// "# key = value" becomes "key = value".
std::string with_defaults_spelled_out(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool is_default = line.starts_with("# ") && line.find(" = ") != std::string::npos &&
                            line.find(" = ") == line.find(' ', 2);
    result += (is_default ? line.substr(2) : line) + "\n";
  }
  return result;
}

TEST(StudyTemplate, ShowsTheTrueDefaults) {
  const std::string text = study_template("a");
  const std::string spelled_out = with_defaults_spelled_out(text);
  EXPECT_NE(spelled_out, text);
  EXPECT_EQ(to_json(parse_study(spelled_out, "s.toml")), to_json(parse_study(text, "s.toml")));
}

}  // namespace
}  // namespace npdr::pipeline
