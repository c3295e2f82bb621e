#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

// The recording is one that another study has simulated, without noise.
std::string study(const std::string& name, const std::string& noise) {
  return pendulum_study(name)
      .only("target", {"recording = \"runs/made/target.h5\""})
      .with("simulator", {"store_every = 40", "segment_length = 200"})
      .only("prior", {"pole_length = { uniform = [0.5, 1.5] }"})
      .with("observation_noise", {noise})
      .method("Refined",
              {"algorithm = \"refine\"", "refine = { level_size = 1000, min_ess = 200 }"})
      .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]", "floor = false"});
}

class Evidence : public CommandTest {
 protected:
  void SetUp() override {
    write("made", pendulum_study("made").method("M"));
    npdr(0, {"run", "made.toml", "--until", "target"});
    for (const char* scale : {"0.05", "0.2"}) {
      const std::string name = std::string("noise-") + scale;
      write(name, study(name, std::string("scale = ") + scale));
    }
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / (name + ".toml")) << text;
  }
};

TEST_F(Evidence, OfTwoNoiseModelsTheSmallerExplainsARecordingWithoutNoiseBetter) {
  EXPECT_TRUE(says(npdr(2, {"evidence", "noise-0.05.toml"}).err,
                   {"npdr evidence: noise-0.05.toml: has no refined posterior yet",
                    "npdr run noise-0.05.toml"}));
  for (const char* file : {"noise-0.05.toml", "noise-0.2.toml"}) {
    npdr(0, {"run", file, "--until", "infer"});
  }
  EXPECT_TRUE(has(npdr(0, {"evidence", "noise-0.2.toml", "noise-0.05.toml"}).out,
                  {"noise-0.05: Refined, 1", "white, scale 0.05", "the best",
                   "noise-0.2: Refined, 1", "very strong evidence against it"}));
  const Outcome outcome = npdr({"evidence", "noise-0.2.toml", "noise-0.05.toml", "--json"});
  const auto json = nlohmann::json::parse(outcome.out);
  const auto& models = json["models"];
  ASSERT_EQ(models.size(), 2u);
  // The posteriors are narrow, the errors 0: a factor of 4 for each number, but for one parameter.
  const double difference =
      models[0]["log_evidence"].get<double>() - models[1]["log_evidence"].get<double>();
  const double per_number = difference / json["num_values"].get<double>();
  EXPECT_NEAR(per_number, std::log(4.0), 0.1);
}

TEST_F(Evidence, RefusesOtherData) {
  const std::string first = study("first", "scale = 0.2");
  const auto write_with = [&](const std::string& name, const std::string& keys) {
    write(name, edited(edited(first, "\"first\"", "\"" + name + "\""),
                       "store_every = 40\nsegment_length = 200", keys));
    npdr(0, {"run", name + ".toml", "--until", "infer"});
  };
  write_with("first", "store_every = 40\nsegment_length = 40");
  // Every stored state is the first of a segment, but another one is given with it.
  write_with("shorter", "store_every = 40\nsegment_length = 20");
  write_with("denser", "store_every = 20\nsegment_length = 40");
  for (const std::string other : {"shorter", "denser"}) {
    EXPECT_TRUE(says(npdr(2, {"evidence", "first.toml", other + ".toml"}).err,
                     {"npdr evidence: " + other + ".toml, infer Refined", "explains other numbers",
                      "store_every and segment_length must be the same"}));
  }
}

// The truth, 1 m, lies outside of the prior.
TEST_F(Evidence, WarnsOfModelsWhoseChecksFail) {
  const auto with_narrow_prior = [&](const std::string& command) {
    return npdr({command, "noise-0.05.toml", "--set", "prior.pole_length={ uniform = [0.5, 0.9] }",
                 "--set", "evaluate.num_samples=200", "--set", "diagnose.checks=['bounds']"});
  };
  const Outcome made = with_narrow_prior("run");
  ASSERT_EQ(made.status, 0) << made.err;
  const Outcome outcome = with_narrow_prior("evidence");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(says(outcome.err, {"warning: Refined: ", "FAIL", "Bounds of the prior"})) << made.out;
}

}  // namespace
}  // namespace npdr::pipeline
