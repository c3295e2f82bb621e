#include "pipeline/config/study_reader.h"

#include <filesystem>

#include "pipeline/config/check.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

const std::string kNumSimulations = "num_simulations = 200";

Study small_study(const std::vector<std::string>& overrides = {}) {
  return parse_study(kStudyText, "s.toml", overrides);
}

TEST(StudyReader, FillsInDefaults) {
  const Study study = small_study();
  EXPECT_EQ(study.name, "small");
  EXPECT_EQ(study.seeds, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(study.target.truth->at("pole_mass"), 1.1);
  EXPECT_EQ(study.target.num_rollouts, 5);
  EXPECT_EQ(study.simulator.integrator, sim::Integrator::erk4);
  EXPECT_EQ(study.simulate.shard_size, 1000);
  EXPECT_EQ(study.methods[0].algorithm.num_simulations, 200);
  EXPECT_EQ(study.methods[0].training.learning_rate, 1e-3);
  EXPECT_EQ(study.methods[1].algorithm.num_simulations, 1000);
  EXPECT_EQ(study.evaluate.metrics, (std::vector<Metric>{Metric::dtw, Metric::rmse}));
  EXPECT_EQ(study.limits.max_failed_fraction, 0.05);
}

TEST(StudyReader, KeepsThePriorInTheOrderOfTheFileWithTheUnitsOfTheSimulator) {
  const std::vector<Marginal> prior = small_study({"prior.gravity={normal=[9.81, 0.1]}"}).prior;
  ASSERT_EQ(prior.size(), 3u);
  EXPECT_EQ(prior[0].name, "pole_mass");
  EXPECT_EQ(prior[0].unit, "kg");
  EXPECT_EQ(prior[0].kind, Marginal::Kind::uniform);
  EXPECT_EQ(prior[0].a, 0.3);
  EXPECT_EQ(prior[0].b, 1.7);
  EXPECT_EQ(prior[1].name, "pole_length");
  EXPECT_EQ(prior[1].kind, Marginal::Kind::log_uniform);
  EXPECT_EQ(prior[2].name, "gravity");
  EXPECT_EQ(prior[2].kind, Marginal::Kind::normal);
  EXPECT_EQ(prior[2].unit, "m/s^2");
}

TEST(StudyReader, ReplacesOlderSpellingsOfNames) {
  const Study study = small_study({"method.algorithm=snpe_c"});
  EXPECT_EQ(study.methods[0].algorithm.kind, inference::Algorithm::npe_c);
  EXPECT_EQ(study.methods[1].density_estimator.kind, inference::EstimatorKind::mdn);
}

TEST(StudyReader, ReadsEveryKindOfKey) {
  const Study study =
      small_study({"method.published={ rmse = { mean = 0.263, std = 0.004 } }",
                   "evaluate.floor=false", "method.embedding.channels=['theta']",
                   "simulator.parameters={gravity=9.8}", "report.title=A title",
                   "observation_noise.scale=1", "report.parameters=['pole_mass', 'pole_length']"});
  EXPECT_EQ(study.methods[1].published.at("rmse").std, 0.004);
  EXPECT_FALSE(study.evaluate.floor);
  EXPECT_EQ(study.methods[0].embedding.channels, std::vector<std::string>{"theta"});
  EXPECT_EQ(study.simulator.parameters.at("gravity"), 9.8);
  EXPECT_EQ(study.report.title, "A title");
  EXPECT_EQ(study.observation_noise.scale, 1.0);
}

TEST(StudyReader, FindsMethodsByName) {
  EXPECT_EQ(small_study().method("NPDR (MoG)").density_estimator.kind,
            inference::EstimatorKind::mdn);
  EXPECT_TRUE(says(message_of<InputError>([] { small_study().method("NPDR (MaG)"); }),
                   {"unknown method 'NPDR (MaG)'", "'NPDR (MAF)'", "known: NPDR (MAF)"}));
}

TEST(StudyReader, KnowsWhereKeysStand) {
  const Study study = small_study({"simulate.shard_size=7"});
  EXPECT_EQ(study.places.of("target.truth").str(), "s.toml:6:9");
  EXPECT_EQ(study.places.of("method[1].embedding.downsample").str(), "s.toml:19:1")
      << "left out: its table";
  EXPECT_EQ(study.places.of("simulate.shard_size").str(), "--set simulate.shard_size=7");
}

TEST(Study, NamesBecomeFolders) {
  EXPECT_EQ(folder_slug("NPDR (MAF)"), "npdr-maf");
  EXPECT_EQ(folder_slug("H = 10"), "h-10");
  EXPECT_EQ(folder_slug("../.."), "unnamed");
}

TEST(StudyReader, TakesARecordingRelativeToTheStudyFile) {
  const TempFolder folder;
  folder.file("r.h5", "");
  folder.file("s.toml", edited(kStudyText, "truth = { pole_mass = 1.1 }", "recording = 'r.h5'"));
  const Study study = read_study(folder / "s.toml");
  EXPECT_EQ(study.target.recording, (folder / "r.h5").string());
  EXPECT_EQ(study.target.num_rollouts, 0);
  EXPECT_FALSE(study.target.truth);
}

TEST(StudyReader, TakesARecordingOfTheCommandLineRelativeToTheCurrentFolder) {
  const TempFolder folder;
  folder.file("s.toml", kStudyText);
  const std::string relative = std::filesystem::relative(folder.file("r.h5", ""));
  const Study study = read_study(folder / "s.toml", {"target.recording=" + relative});
  EXPECT_EQ(study.target.recording, relative);
  EXPECT_FALSE(study.target.truth) << "the other source of rollouts is removed";
}

TEST(StudyReader, ATruthOfTheCommandLineReplacesTheRecordingOfTheFile) {
  const std::string text =
      edited(kStudyText, "truth = { pole_mass = 1.1 }", "recording = 'missing.h5'");
  const Study study = parse_study(text, "s.toml", {"target.truth.pole_mass=1.3"});
  EXPECT_FALSE(study.target.recording);
  EXPECT_EQ(study.target.truth->at("pole_mass"), 1.3);
}

TEST(StudyReader, ARecordingOfTheCommandLineTakesTheTruthsRolloutsAway) {
  const std::filesystem::path recording = NPDR_SOURCE_DIR "/CMakeLists.txt";  // has to exist
  const std::string text = edited(kStudyText, "truth = { pole_mass = 1.1 }",
                                  "truth = { pole_mass = 1.1 }\nnum_rollouts = 5\nseed = 3");
  const std::string set = "target.recording=" + recording.string();
  const Study study = parse_study(text, "s.toml", {set});
  EXPECT_FALSE(study.target.truth);
  EXPECT_EQ(study.target.num_rollouts, 0);
  // What the command line says is of the recording, whichever stands first.
  for (const auto& overrides : {std::vector<std::string>{set, "target.num_rollouts=2"},
                                std::vector<std::string>{"target.num_rollouts=2", set}}) {
    EXPECT_EQ(parse_study(text, "s.toml", overrides).target.num_rollouts, 2);
  }
}

TEST(StudyReader, ARecordingOfTheCommandLineTakesTheTruthsBeginningAway) {
  const std::string text = edited(
      kStudyText, "name = \"pendulum\"",
      "worker = \"true\"\nstates = [\"q\"]\ndt = 0.1\nnum_steps = 9\ninitial_states = [[1.0]]");
  const std::filesystem::path recording = NPDR_SOURCE_DIR "/CMakeLists.txt";  // has to exist
  EXPECT_EQ(problems_of(text, {"target.recording=" + recording.string()}), "");
}

TEST(StudyReader, OverridesEveryMethodOrOne) {
  Study study = small_study({"method.num_rounds=2"});
  EXPECT_EQ(study.methods[0].algorithm.num_rounds, 2);
  EXPECT_EQ(study.methods[1].algorithm.num_rounds, 2);
  study = small_study({"method.\"NPDR (MAF)\".num_rounds=3", "method.training.batch_size=20"});
  EXPECT_EQ(study.methods[0].algorithm.num_rounds, 3);
  EXPECT_EQ(study.methods[1].algorithm.num_rounds, 1);
  EXPECT_EQ(study.methods[1].training.batch_size, 20);
}

TEST(StudyReader, NetworksSeePrincipalComponentsWhereNothingElseIsSaid) {
  using enum inference::EmbeddingKind;
  const auto embedding_of = [](const std::string& setting) {
    return small_study({"method.\"NPDR (MAF)\"." + setting}).methods[0].embedding;
  };
  const inference::EmbeddingConfig usual = embedding_of("num_rollouts=2");
  EXPECT_EQ(usual.kind, all_steps);
  EXPECT_EQ(usual.principal_components, 20);
  EXPECT_EQ(embedding_of("embedding.downsample=2").principal_components, 20);
  EXPECT_EQ(embedding_of("embedding.kind=all_steps").principal_components, 0);
  EXPECT_EQ(embedding_of("embedding.principal_components=3").principal_components, 3);
  EXPECT_EQ(embedding_of("embedding.average_rollouts=true").kind, convolution);
  EXPECT_EQ(embedding_of("embedding.features=20").kind, convolution);
  EXPECT_EQ(embedding_of("embedding.features=20").principal_components, 0);
  EXPECT_EQ(embedding_of("embedding.kind=linear").principal_components, 0);
  EXPECT_EQ(embedding_of("algorithm=abc_rejection").principal_components, 0);
  EXPECT_EQ(embedding_of("algorithm=abc_rejection").kind, all_steps);
  const auto of_likelihood = small_study(
      {"method.\"NPDR (MAF)\".algorithm=nle", "method.\"NPDR (MAF)\".embedding.features=20"});
  EXPECT_EQ(of_likelihood.methods[0].embedding.kind, all_steps) << "it can't train layers";
  EXPECT_EQ(of_likelihood.methods[0].embedding.principal_components, 20);
  std::vector<std::string> furuta = {"simulator.name=furuta"};
  for (const char* name : {"gravity", "rotary_mass", "rotary_length", "motor_constant"}) {
    furuta.push_back(std::string("prior.") + name + "={ uniform = [0.5, 1.0] }");
  }
  EXPECT_EQ(small_study(furuta).methods[0].embedding.principal_components, 24) << "4 x 6";
}

TEST(StudyReader, AppliesOverridesInTheirOrder) {
  EXPECT_EQ(small_study({"simulate.shard_size=64", "simulate.shard_size=32"}).simulate.shard_size,
            32);
  EXPECT_EQ(small_study({"prior.pole_mass={uniform=[0.5, 0.6]}"}).prior[0].b, 0.6);
}

// As in a file: the order of theta's columns.
TEST(StudyReader, NewKeysHaveTheOrderOfTheCommandLine) {
  const auto names = [](const std::vector<std::string>& overrides) {
    std::string text;
    for (const inference::Marginal& m : small_study(overrides).prior) text += m.name + " ";
    return text;
  };
  EXPECT_EQ(
      names({"prior={ pole_mass = { uniform = [0.5, 0.6] }, damping = { uniform = [0, 1] } }"}),
      "pole_mass damping ");
  EXPECT_EQ(
      names({"prior.gravity={ uniform = [9.0, 10.0] }", "prior.damping={ uniform = [0, 1] }"}),
      "pole_mass pole_length gravity damping ");
}

TEST(StudyReader, ABareWordOfAnOverrideIsText) {
  EXPECT_EQ(small_study({"study.name=other-name"}).name, "other-name");
  EXPECT_EQ(small_study({"report.title=Figure #3: a=b"}).report.title, "Figure #3: a=b");
  EXPECT_EQ(small_study({"report.title= \"quoted\" "}).report.title, "quoted");
}

TEST(StudyReader, AcceptsWindowsLineEndsAndAByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : std::string(kStudyText)) text += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(problems_of(text), "");
}

TEST(StudyReader, OverridesMustBeUtf8) {
  for (const char* text : {"\xe1z", "a\x7f"}) {
    EXPECT_TRUE(says(problems_of(kStudyText, {std::string("target.recording=") + text}),
                     {"--set target.recording="}));
  }
}

TEST(StudyReader, NamesTooLongForTheFileSystemAreNoSurprise) {
  const std::string name(5000, 'a');
  EXPECT_TRUE(has(message_of<InputError>([&] { read_study(name); }), "can't be opened"));
  EXPECT_TRUE(has(problems_of(kStudyText, {"target.recording=" + name.substr(0, 4000)}),
                  "must be an existing HDF5 file"));
}

TEST(StudyReader, ATableOfChecksMeansAllOfThem) {
  const auto checks = [](const std::string& text) {
    return parse_study(kStudyText + text, "s.toml", {}).diagnose.checks.size();
  };
  EXPECT_EQ(checks("[diagnose]\n"), 12u);
  EXPECT_EQ(checks("[diagnose]\nchecks = ['sbc']\n"), 1u);
  EXPECT_EQ(checks("[diagnose]\nchecks = []\n"), 0u);
}

// Calibration is among them where its 300 simulations are at most a quarter of each method's.
TEST(StudyReader, WithoutATableStudiesAreCheckedByWhatCostsLittle) {
  const auto checks = [](const std::vector<std::string>& overrides) {
    return join(to_names(parse_study(kStudyText, "s.toml", overrides).diagnose.checks));
  };
  const std::string cheap =
      "predictive, ood, failures, training, sampling, bounds, contraction, fit";
  EXPECT_EQ(checks({"target.held_out=1"}), cheap + ", held_out");
  EXPECT_EQ(checks({"method.num_simulations=1199"}), cheap);
  EXPECT_EQ(checks({"method.num_simulations=1200"}), "sbc, coverage, " + cheap);
  EXPECT_EQ(checks({"method.num_simulations=1200", "method.\"NPDR (MAF)\".algorithm=nle",
                    "method.\"NPDR (MAF)\".embedding.kind=all_steps"}),
            cheap);
}

TEST(StudyReader, PopulationsOfSmcAreHalvedUnlessAStudySaysOtherwise) {
  const auto quantile = [](const std::string& method) {
    return parse_study(edited(kStudyText, kNumSimulations, method), "s.toml", {})
        .methods[0]
        .abc.quantile;
  };
  EXPECT_EQ(quantile("algorithm = 'abc_smc'"), 0.5);
  EXPECT_EQ(quantile("algorithm = 'abc_smc'\nabc.quantile = 0.2"), 0.2);
  EXPECT_EQ(quantile("algorithm = 'abc_rejection'\nnum_rounds = 1"), 0.1);
}

TEST(StudyReader, TheAlgorithmFollowsFromSettingsUnlessAStudySaysIt) {
  using inference::Algorithm;
  const auto algorithm = [](const std::string& method) {
    return parse_study(edited(kStudyText, kNumSimulations, method), "s.toml", {})
        .methods[0]
        .algorithm.kind;
  };
  EXPECT_EQ(algorithm(kNumSimulations), Algorithm::npe_nle);
  EXPECT_EQ(algorithm("num_rounds = 2"), Algorithm::npe_nle);
  EXPECT_EQ(algorithm("num_atoms = 5"), Algorithm::npe_c);
}

}  // namespace
}  // namespace npdr::pipeline
