#include "pipeline/config/study_reader.h"

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "pipeline/config/check.h"
#include "pipeline/config/study_json.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

const std::string kNumSimulations = "num_simulations = 200";

Study small_study(const std::vector<std::string>& overrides = {}) {
  return parse_study(kStudyText, "s.toml", overrides);
}

TEST(StudyReader, ReadsEveryKindOfKeyAndFillsInDefaults) {
  const Study study = small_study(
      {"method.published={ rmse = { mean = 0.263, std = 0.004 } }", "evaluate.floor=false",
       "method.embedding.channels=['theta']", "simulator.parameters={gravity=9.8}",
       "report.title=Figure #3: a=b", "observation_noise.scale=1",
       "report.parameters=['pole_mass', 'pole_length']", "method.\"NPDR (MAF)\".algorithm=snpe_c"});
  EXPECT_EQ(study.name, "small");
  EXPECT_EQ(study.seeds, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(study.target.truth->at("pole_mass"), 1.1);
  EXPECT_EQ(study.target.num_rollouts, 5);
  EXPECT_EQ(study.simulator.integrator, sim::Integrator::erk4);
  EXPECT_EQ(study.simulator.parameters.at("gravity"), 9.8);
  EXPECT_EQ(study.simulate.shard_size, 1000);
  EXPECT_EQ(study.observation_noise.scale, 1.0);
  EXPECT_EQ(study.methods[0].algorithm.num_simulations, 200);
  EXPECT_EQ(study.methods[0].algorithm.kind, inference::Algorithm::npe_c) << "another spelling";
  EXPECT_EQ(study.methods[0].training.learning_rate, 1e-3);
  EXPECT_EQ(study.methods[0].embedding.channels, std::vector<std::string>{"theta"});
  EXPECT_EQ(study.methods[1].algorithm.num_simulations, 1000);
  EXPECT_EQ(study.methods[1].density_estimator.kind, inference::EstimatorKind::mdn);
  EXPECT_EQ(study.methods[1].published.at("rmse").std, 0.004);
  EXPECT_EQ(study.evaluate.metrics, (std::vector<Metric>{Metric::dtw, Metric::rmse}));
  EXPECT_FALSE(study.evaluate.floor);
  EXPECT_EQ(study.report.title, "Figure #3: a=b") << "a bare word is text";
  EXPECT_EQ(study.limits.max_failed_fraction, 0.05);
  EXPECT_EQ(small_study({"report.title= \"quoted\" "}).report.title, "quoted");
}

TEST(StudyReader, KeepsThePriorInTheOrderOfTheFileWithTheUnitsOfTheSimulator) {
  using enum Marginal::Kind;
  const auto expect_prior = [](const std::vector<std::string>& overrides,
                               const std::vector<Marginal>& expected) {
    EXPECT_EQ(to_json(small_study(overrides).prior), to_json(expected));
  };
  const Marginal mass{"pole_mass", "kg", uniform, 0.3, 1.7},
      half{"pole_mass", "kg", uniform, 0.5, 0.6};
  const Marginal length{"pole_length", "m", log_uniform, 0.3, 1.7};
  const Marginal gravity{"gravity", "m/s^2", normal, 9.81, 0.1};
  const Marginal damping{"damping", "N m s/rad", uniform, 0.0, 1.0};
  const std::string damped = "{ uniform = [0, 1] }";
  expect_prior({"prior.gravity={normal=[9.81, 0.1]}"}, {mass, length, gravity});
  expect_prior({"prior.pole_mass={uniform=[0.5, 0.6]}"}, {half, length});
  expect_prior({"prior={ pole_mass = { uniform = [0.5, 0.6] }, damping = " + damped + " }"},
               {half, damping});
  expect_prior({"prior.gravity={ normal = [9.81, 0.1] }", "prior.damping=" + damped},
               {mass, length, gravity, damping});
}

TEST(StudyReader, FindsMethodsByName) {
  EXPECT_EQ(small_study().method("NPDR (MoG)").density_estimator.kind,
            inference::EstimatorKind::mdn);
  EXPECT_TRUE(has(message_of<InputError>([] { small_study().method("NPDR (MaG)"); }),
                  "unknown method 'NPDR (MaG)'"));
}

TEST(StudyReader, KnowsWhereKeysStand) {
  const Study study = small_study({"simulate.shard_size=7"});
  EXPECT_EQ(study.places.of("target.truth").str(), "s.toml:6:9");
  EXPECT_EQ(study.places.of("method[1].embedding.downsample").str(), "s.toml:19:1")
      << "left out: its table";
  EXPECT_EQ(study.places.of("simulate.shard_size").str(), "--set simulate.shard_size=7");
}

TEST(StudyReader, TakesARecordingRelativeToItsPlace) {
  const TempFolder folder;
  const std::string relative = std::filesystem::relative(folder.file("r.h5", ""));
  folder.file("s.toml", edited(kStudyText, "truth = { pole_mass = 1.1 }", "recording = 'r.h5'"));
  const Study of_file = read_study(folder / "s.toml");
  EXPECT_EQ(of_file.target.recording, (folder / "r.h5").string());
  folder.file("s.toml", kStudyText);
  const Study of_words = read_study(folder / "s.toml", {"target.recording=" + relative});
  EXPECT_EQ(of_words.target.recording, relative) << "to the current folder";
  for (const Study& study : {of_file, of_words}) {
    EXPECT_EQ(study.target.num_rollouts, 0);
    EXPECT_FALSE(study.target.truth) << "the other source of rollouts is removed";
  }
}

TEST(StudyReader, ATruthOfTheCommandLineReplacesTheRecordingOfTheFile) {
  const std::string text =
      edited(kStudyText, "truth = { pole_mass = 1.1 }", "recording = 'missing.h5'");
  const Study study = parse_study(text, "s.toml", {"target.truth.pole_mass=1.3"});
  EXPECT_FALSE(study.target.recording);
  EXPECT_EQ(study.target.truth->at("pole_mass"), 1.3);
}

TEST(StudyReader, ARecordingOfTheCommandLineTakesTheTruthsRolloutsAndBeginningAway) {
  const std::string set = "target.recording=" NPDR_SOURCE_DIR "/CMakeLists.txt";  // has to exist
  const std::string text = edited(kStudyText, "truth = { pole_mass = 1.1 }",
                                  "truth = { pole_mass = 1.1 }\nnum_rollouts = 5\nseed = 3");
  const Study study = parse_study(text, "s.toml", {set});
  EXPECT_FALSE(study.target.truth);
  EXPECT_EQ(study.target.num_rollouts, 0);
  // What the command line says is of the recording, whichever stands first.
  const std::string two = "target.num_rollouts=2";
  for (const auto& overrides : {std::vector{set, two}, std::vector{two, set}}) {
    EXPECT_EQ(parse_study(text, "s.toml", overrides).target.num_rollouts, 2);
  }
  const std::string worker = edited(
      kStudyText, "name = \"pendulum\"",
      "worker = \"true\"\nstates = [\"q\"]\ndt = 0.1\nnum_steps = 9\ninitial_states = [[1.0]]");
  EXPECT_EQ(problems_of(worker, {set}), "");
}

TEST(StudyReader, OverridesEveryMethodOrOneInTheirOrder) {
  const Study study = small_study({"simulate.shard_size=64", "method.num_rounds=2",
                                   "method.\"NPDR (MAF)\".num_rounds=3", "simulate.shard_size=32",
                                   "method.training.batch_size=20"});
  EXPECT_EQ(study.methods[0].algorithm.num_rounds, 3);
  EXPECT_EQ(study.methods[1].algorithm.num_rounds, 2);
  EXPECT_EQ(study.methods[1].training.batch_size, 20);
  EXPECT_EQ(study.simulate.shard_size, 32);
}

TEST(StudyReader, NetworksSeePrincipalComponentsWhereNothingElseIsSaid) {
  using enum inference::EmbeddingKind;
  const std::string maf = "method.\"NPDR (MAF)\".", nle = maf + "algorithm=nle";
  std::vector<std::string> furuta = {"simulator.name=furuta"};
  for (const char* name : {"gravity", "rotary_mass", "rotary_length", "motor_constant"}) {
    furuta.push_back(std::string("prior.") + name + "={ uniform = [0.5, 1.0] }");
  }
  const std::vector<std::tuple<std::vector<std::string>, inference::EmbeddingKind, Index>> cases = {
      {{maf + "num_rollouts=2"}, all_steps, 20},
      {{maf + "embedding.downsample=2"}, all_steps, 20},
      {{maf + "embedding.kind=all_steps"}, all_steps, 0},
      {{maf + "embedding.principal_components=3"}, all_steps, 3},
      {{maf + "embedding.average_rollouts=true"}, convolution, 0},
      {{maf + "embedding.features=20"}, convolution, 0},
      {{maf + "embedding.kind=linear"}, linear, 0},
      {{maf + "algorithm=abc_rejection"}, all_steps, 0},
      {{nle, maf + "embedding.features=20"}, all_steps, 20},  // it can't train layers
      {furuta, all_steps, 24}};                               // 4 x 6
  for (const auto& [overrides, kind, components] : cases) {
    const inference::EmbeddingConfig embedding = small_study(overrides).methods[0].embedding;
    EXPECT_EQ(embedding.kind, kind) << overrides.back();
    EXPECT_EQ(embedding.principal_components, components) << overrides.back();
  }
}

TEST(StudyReader, OddTextsAreReadOrRefused) {
  std::string windows = "\xEF\xBB\xBF";
  for (const char c : std::string(kStudyText)) windows += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(problems_of(windows), "");
  const std::string name(5000, 'a');  // too long for the file system
  EXPECT_TRUE(has(message_of<InputError>([&] { read_study(name); }), "can't be opened"));
  for (const auto& [recording, said] :
       {std::pair<std::string, std::string>{"\xe1z", "--set target.recording="},  // not UTF-8
        {"a\x7f", "--set target.recording="},
        {name.substr(0, 4000), "must be an existing HDF5 file"}}) {
    EXPECT_TRUE(has(problems_of(kStudyText, {"target.recording=" + recording}), said));
  }
}

// Without a table studies are checked by what costs little: calibration is among that where its 300
// simulations are at most a quarter of each method's.
TEST(StudyReader, ATableOfChecksMeansAllOfThem) {
  const auto checks = [](const std::string& table, const std::vector<std::string>& overrides = {}) {
    return join(to_names(parse_study(kStudyText + table, "s.toml", overrides).diagnose.checks));
  };
  EXPECT_EQ(std::ranges::count(checks("[diagnose]\n"), ','), 12);
  EXPECT_EQ(checks("[diagnose]\nchecks = ['sbc']\n"), "sbc");
  EXPECT_EQ(checks("[diagnose]\nchecks = []\n"), "");
  const std::string cheap =
      "predictive, width, ood, failures, training, sampling, bounds, contraction, fit";
  const std::string enough = "method.num_simulations=1200";
  EXPECT_EQ(checks("", {"target.held_out=1"}), cheap + ", held_out");
  EXPECT_EQ(checks("", {"method.num_simulations=1199"}), cheap);
  EXPECT_EQ(checks("", {enough}), "sbc, coverage, " + cheap);
  EXPECT_EQ(checks("", {enough, "method.\"NPDR (MAF)\".algorithm=nle",
                        "method.\"NPDR (MAF)\".embedding.kind=all_steps"}),
            cheap);
}

TEST(StudyReader, DefaultsFollowFromWhatAStudySays) {
  using enum inference::Algorithm;
  const auto method = [](const std::string& lines) {
    return parse_study(edited(kStudyText, kNumSimulations, lines), "s.toml", {}).methods[0];
  };
  EXPECT_EQ(method("algorithm = 'abc_smc'").abc.quantile, 0.5);
  EXPECT_EQ(method("algorithm = 'abc_smc'\nabc.quantile = 0.2").abc.quantile, 0.2);
  EXPECT_EQ(method("algorithm = 'abc_rejection'\nnum_rounds = 1").abc.quantile, 0.1);
  EXPECT_EQ(method(kNumSimulations).algorithm.kind, npe_nle);
  EXPECT_EQ(method("num_rounds = 2").algorithm.kind, npe_nle);
  EXPECT_EQ(method("num_atoms = 5").algorithm.kind, npe_c);
}

}  // namespace
}  // namespace npdr::pipeline
