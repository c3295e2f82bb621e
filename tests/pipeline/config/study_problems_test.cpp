// Problems of studies: place, value and what is allowed are what users must be told.
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::string kOneMethod = "num_simulations = 200";

TEST(StudyProblems, NamesPositionKeyValueAndWhatIsAllowed) {
  EXPECT_TRUE(says(problems_after(kOneMethod, "training = { learning_rate = -0.1 }"),
                   {"s.toml:17:30: method.training.learning_rate = -0.1", "must be > 0"}));
  EXPECT_TRUE(
      says(problems_after(kOneMethod, "training.validation_fraction = 1.0"),
           {"s.toml:17:32: method.training.validation_fraction = 1.0", "must be > 0 and < 1"}));
  EXPECT_TRUE(
      says(problems_after("seeds = [1, 2]", "seeds = [1, 1]"),
           {"s.toml:3:9: study.seeds = [1, 1]", "must be distinct and >= 0, 1 to 1000 of them"}));
  EXPECT_TRUE(says(
      problems_after("\"small\"", "\"../small\""),
      {"s.toml:2:8: study.name = '../small'",
       "must be a folder name of 1 to 100 letters, digits, '_', '-' and '.' that doesn't begin "
       "with '.'"}));
}

TEST(StudyProblems, NoiseIsGivenOrHasAPrior) {
  const auto problems = [](const std::string& noise) {
    return problems_after("[simulator]", "[observation_noise]\n" + noise + "\n[simulator]");
  };
  EXPECT_EQ(problems("scale_prior = [0.2, 1.0]\ncorrelation = 0.5"), "");
  EXPECT_TRUE(says(problems("scale = 0.1\nscale_prior = [0.2, 1.0]"),
                   {"s.toml:10:15: observation_noise.scale_prior", "must be left out",
                    "observation_noise.scale is given"}));
  EXPECT_TRUE(says(problems("correlation = 0.5"),
                   {"s.toml:9:15: observation_noise.correlation", "must be left out",
                    "there is no noise without observation_noise.scale"}));
  EXPECT_TRUE(says(problems("std = { theta = -1.0 }"),
                   {"s.toml:9:17: observation_noise.std.theta = -1", "must be >= 0"}));
  EXPECT_TRUE(says(problems("std = { thet = 1.0 }"),
                   {"s.toml:9:16: observation_noise.std: unknown channel 'thet'", "'theta'"}));
}

TEST(StudyProblems, ReportsAllOfThemInTheOrderOfTheFile) {
  std::string text = edited(kStudyText, "seeds = [1, 2]", "seeds = []\nsede = 3");
  text = edited(text, "1.1", "1000");
  text = edited(text, kOneMethod, "num_rounds = 0\ntraining = { clip_norm = 'x' }");
  EXPECT_TRUE(
      says(problems_of(text),
           {"s.toml:3:9: study.seeds = []", "must be distinct and >= 0, 1 to 1000 of them",
            "\ns.toml:4:1: study: unknown key 'sede'", "'seeds'", "known: name",
            "\ns.toml:7:23: target.truth.pole_mass = 1000", "must be between 0.001 and 100 kg",
            "\ns.toml:18:14: method.num_rounds = 0", "must be >= 1 and <= 200",
            "\ns.toml:19:26: method.training.clip_norm = 'x'", "must be a finite number, > 0"}));
}

TEST(StudyProblems, OverridesMustBeUtf8) {
  for (const char* text : {"\xe1z", "a\x7f"}) {
    EXPECT_TRUE(says(problems_of(kStudyText, {std::string("target.recording=") + text}),
                     {"--set target.recording="}));
  }
}

TEST(StudyProblems, NamesTheNearestKeyAndTheKnownOnes) {
  EXPECT_TRUE(says(problems_after("[simulator]", "[simulater]"),
                   {"s.toml: simulator.name is missing", join(sim::simulator_names()),
                    "a command, worker, library, mjcf or dataset",
                    "\ns.toml:8:2: unknown key 'simulater'", "'simulator'", "known: study"}));
  EXPECT_TRUE(says(problems_after(kOneMethod, "training.batchsize = 3"),
                   {"s.toml:17:10: method.training: unknown key 'batchsize'", "'batch_size'",
                    "known: learning_rate"}));
}

TEST(StudyProblems, NamesTheNearestOfAFewNames) {
  EXPECT_TRUE(
      says(problems_after("\"pendulum\"", "\"pendulm\""),
           {"s.toml:9:8: simulator.name = 'pendulm'", join(sim::simulator_names()), "'pendulum'"}));
  EXPECT_TRUE(
      says(problems_after(kOneMethod, "algorithm = \"npe_d\""),
           {"s.toml:17:13: method.algorithm = 'npe_d'", join(names_of<inference::Algorithm>()),
            "'" + nearest_name("npe_d", names_of<inference::Algorithm>()) + "'"}));
}

TEST(StudyProblems, WrongTypesSayWhatTypeIsDue) {
  EXPECT_TRUE(says(
      problems_after(kOneMethod, "num_simulations = 1e3"),
      {"s.toml:17:19: method.num_simulations = 1000.0", "must be an integer, >= 1 and <= 10^9"}));
  EXPECT_TRUE(says(problems_after(kOneMethod, "training = 3"),
                   {"s.toml:17:12: method.training = 3", "must be a table"}));
  EXPECT_TRUE(says(problems_after("\"small\"", "[1]"),
                   {"s.toml:2:8: study.name = [1]",
                    "must be text, a folder name of 1 to 100 letters, digits, "
                    "'_', '-' and '.' that doesn't begin with '.'"}));
  EXPECT_TRUE(says(problems_after("[1, 2]", "[1, -2]"),
                   {"s.toml:3:9: study.seeds = [1, -2]",
                    "must be a list of integers, distinct and >= 0, 1 to 1000 of them"}));
  EXPECT_TRUE(says(problems_after("{ pole_mass = 1.1 }", "{ pole_mass = 'a', pole_length = [] }"),
                   {"s.toml:6:23: target.truth.pole_mass = 'a'", "must be a finite number",
                    "\ns.toml:6:42: target.truth.pole_length = []", "must be a finite number"}));
  EXPECT_TRUE(says(problems_after(kOneMethod, "published.rmse = 0.3"),
                   {"s.toml:17:18: method.published.rmse = 0.3",
                    "must be a table, { mean = 0.263, std = 0.004 }"}));
}

TEST(StudyProblems, RejectsNumbersThatArentFiniteAndIntegersOutOfRange) {
  EXPECT_TRUE(says(problems_after("1.1", "inf"),
                   {"s.toml:6:23: target.truth.pole_mass = inf", "must be a finite number"}));
  EXPECT_TRUE(
      says(problems_after(kOneMethod, "training.clip_norm = nan"),
           {"s.toml:17:22: method.training.clip_norm = nan", "must be a finite number, > 0"}));
  EXPECT_TRUE(says(
      problems_after(kOneMethod, "num_simulations = 9223372036854775807"),
      {"s.toml:17:19: method.num_simulations = 9223372036854775807", "must be >= 1 and <= 10^9"}));
  EXPECT_EQ(problems_after(kOneMethod, "num_simulations = 99223372036854775807").substr(0, 14),
            "s.toml:17:39: ");
}

TEST(StudyProblems, ChecksThePriorAgainstTheSimulator) {
  const std::string entry = "{ uniform = [0.3, 1.7] }";
  EXPECT_TRUE(
      says(problems_after(entry, "{ uniform = [1.7, 0.3] }"),
           {"s.toml:12:13: prior.pole_mass = [1.7, 0.3]", "must be [low, high] with low < high"}));
  for (const std::string range :
       {"uniform = [1.0, 1.0000000000001]", "uniform = [0, 1e-310]", "normal = [1.0, 5e-324]"}) {
    EXPECT_TRUE(says(problems_after(entry, "{ " + range + " }"),
                     {"s.toml:12:13: prior.pole_mass", ">= 1e-300 and 1e-12 of the values' size"}))
        << range;
  }
  EXPECT_TRUE(says(problems_after(entry, "{ uniform = [0.3, 500] }"),
                   {"s.toml:12:13: prior.pole_mass = [0.3, 500]",
                    "must be inside of what is physically possible, [0.001, 100] kg"}));
  EXPECT_TRUE(says(problems_after(entry, "{ log_uniform = [0.0, 1.0] }"),
                   {"s.toml:12:13: prior.pole_mass = [0, 1]",
                    "must be [low, high] with low > 0 for log_uniform"}));
  EXPECT_TRUE(says(problems_after(entry, "{ normal = [1.0, 0.0] }"),
                   {"s.toml:12:13: prior.pole_mass = [1, 0]", "must be [mean, std] with std > 0"}));
  EXPECT_TRUE(says(problems_after(entry, "{ normal = [-1.0, 1.0] }"),
                   {"s.toml:12:13: prior.pole_mass = [-1, 1]",
                    "must be [mean, std] with at most 0.001 of its mass outside of what is "
                    "physically possible, [0.001, 100] kg, found 0.84",
                    "take a smaller std, uniform or log_uniform"}));
  EXPECT_NE(problems_after(entry, "{ normal = [0.3, 0.1] }").find("found 0.0014;"),
            std::string::npos);
  EXPECT_NE(problems_after(entry, "{ normal = [90.0, 10.0] }").find("found 0.16;"),
            std::string::npos);
  EXPECT_EQ(problems_after(entry, "{ normal = [0.311, 0.1] }"), "") << "3.1 deviations";
  EXPECT_TRUE(says(problems_after(entry, "{ log_normal = [0.0, -1.0] }"),
                   {"s.toml:12:13: prior.pole_mass = [0, -1]",
                    "must be [mean of log, std of log] with std > 0"}));
  EXPECT_NE(problems_after(entry, "{ log_normal = [2.3, 1.0] }").find("found 0.011;"),
            std::string::npos)
      << "2.305 deviations below log 100";
  EXPECT_EQ(problems_after(entry, "{ log_normal = [0.0, 1.0] }"), "");
  EXPECT_TRUE(says(
      problems_after(entry, "{ log_normal = [-800.0, 1.0] }"),
      {"s.toml:12:13: prior.pole_mass = [-800, 1]",
       "must be [mean of log, std of log] with exp(mean +- 9 std) within the range of double"}));
  EXPECT_TRUE(says(
      problems_after("pole_mass = { uni", "pole_mas = { uni"),
      {"s.toml:12:12: prior: unknown parameter 'pole_mas'", "'pole_mass'", "known: pole_mass"}));
}

TEST(StudyProblems, SaysWhatAPriorsEntryMustBe) {
  const std::string must =
      ", must be { uniform = [low, high] }, { log_uniform = [low, high] }, "
      "{ normal = [mean, std] } or { log_normal = [mean of log, std of log] }, of finite numbers";
  for (const std::string entry :
       {"{ unform = [0.3, 1.7] }", "{ uniform = [0.3] }", "{ uniform = [0.3, 'b'] }", "{  }",
        "{ normal = [0.3, 1.7], uniform = [0.3, 1.7] }", "[0.3, 1.7]",
        "{ uniform = [0.3, inf] }"}) {
    EXPECT_EQ(problems_after("{ uniform = [0.3, 1.7] }", entry),
              "s.toml:12:13: prior.pole_mass = " + entry + must);
  }
}

TEST(StudyProblems, APriorNeedsAParameterAndAStudyAMethod) {
  EXPECT_TRUE(
      says(problems_of("[study]\nname = 'a'\n[target]\ntruth = {}\n[simulator]\nname = 'pendulum'"),
           {"s.toml: prior is missing", "must be a table of distributions, of 1 to 1000 parameters",
            "\ns.toml: needs at least one [[method]] table"}));
}

TEST(StudyProblems, AParameterCantBeInferredAndFixed) {
  EXPECT_TRUE(
      says(problems_after("name = \"pendulum\"", "name = \"pendulum\"\nparameters.pole_mass = 1"),
           {"s.toml:13:13: 'pole_mass' is in the prior and in simulator.parameters",
            "must be in one of them"}));
  EXPECT_TRUE(
      says(problems_after("name = \"pendulum\"", "name = \"pendulum\"\nparameters.gravity = -1"),
           {"s.toml:10:22: simulator.parameters.gravity = -1", "must be between 0 and 30 m/s^2"}));
}

TEST(StudyProblems, ATargetHasOneSource) {
  EXPECT_TRUE(says(
      problems_after("truth = { pole_mass = 1.1 }", ""),
      {"s.toml:5:1: target has neither recording = \"file.h5\" nor truth = { parameter = value }",
       "must have one of them"}));
  EXPECT_TRUE(
      says(problems_after("truth = {", "recording = 'a.h5'\ntruth = {"),
           {"s.toml:5:1: target has both recording = \"file.h5\" and truth = { parameter = value }",
            "must have one of them"}));
  EXPECT_TRUE(says(problems_after("truth = { pole_mass = 1.1 }", "recording = 'a.h5'\nseed = 3"),
                   {"s.toml:6:13: target.recording = 'a.h5'", "must be an existing HDF5 file",
                    "\ns.toml:7:8: target.seed = 3", "must be left out with a recording"}));
  EXPECT_TRUE(says(problems_after("truth = {", "num_rollouts = 0\ntruth = {"),
                   {"s.toml:6:16: target.num_rollouts = 0", "must be >= 1 with a truth"}));
}

TEST(StudyProblems, EmbeddingsFitTheRolloutsOfATruth) {
  EXPECT_EQ(problems_after(kOneMethod, "embedding = { downsample = 200 }"), "");
  EXPECT_TRUE(says(problems_after(kOneMethod, "embedding = { downsample = 201 }"),
                   {"s.toml:17:28: method.embedding.downsample = 201", "must be <= 200"}));
  EXPECT_TRUE(problems_after("\"pendulum\"", "\"pendulum\"\nstore_every = 201")
                  .starts_with("s.toml:10:15: simulator.store_every = 201, must be <= 200, so that "
                               "two of the 400 states of a rollout are left\ns.toml:16:1: "
                               "method.embedding"));
  EXPECT_TRUE(says(
      problems_after(kOneMethod, "embedding = { kind = 'convolution', principal_components = 5 }"),
      {"s.toml:17:60: method.embedding.principal_components = 5",
       "must be 0 with kind 'convolution'", "'all_steps' has principal components"}));
}

TEST(StudyProblems, TheReportShowsParametersOfThePrior) {
  EXPECT_TRUE(says(problems_of(std::string(kStudyText) + "[report]\nparameters = ['gravity']"),
                   {"s.toml:23:14: report.parameters: unknown parameter of the prior 'gravity'",
                    "known: pole_mass"}));
  EXPECT_TRUE(says(
      problems_of(std::string(kStudyText) + "[report]\nparameters = ['pole_mass', 'pole_mass']"),
      {"s.toml:23:14: report.parameters = [pole_mass, pole_mass]",
       "must be 1 to 15 different parameters of the prior, or none"}));
  EXPECT_EQ(problems_of(kStudyText, {"report.parameters=['pole_mass']"}), "");
  EXPECT_TRUE(says(problems_of(kStudyText, {"report.symbols={ pole_mass = '\\input x' }"}),
                   {"--set report.symbols={ pole_mass = '\\input x' }: report.symbols.pole_mass",
                    "must be a formula of letters"}));
  EXPECT_TRUE(says(problems_of(kStudyText, {"report.symbols={ gravity = 'g' }"}),
                   {"--set report.symbols={ gravity = 'g' }: report.symbols",
                    "unknown parameter of the prior 'gravity'"}));
  EXPECT_EQ(problems_of(kStudyText, {"report.symbols={ pole_mass = 'm_p' }"}), "");
}

TEST(StudyProblems, OfTheCommandLineNameTheOverride) {
  EXPECT_TRUE(
      says(problems_of(kStudyText, {"simulate.shard_size=0"}),
           {"--set simulate.shard_size=0: simulate.shard_size = 0", "must be >= 1 and <= 10^9"}));
  EXPECT_TRUE(says(problems_of(kStudyText, {"simulate.shard_sise=3"}),
                   {"--set simulate.shard_sise=3: simulate: unknown key 'shard_sise'",
                    "'shard_size'", "known: shard_size"}));
  EXPECT_TRUE(
      says(problems_of(kStudyText, {"simulte.shard_size=3"}),
           {"--set simulte.shard_size=3: unknown key 'simulte'", "'simulate'", "known: study"}));
  EXPECT_TRUE(says(problems_of(kStudyText, {"target.recording=no.h5"}),
                   {"--set target.recording=no.h5: target.recording = 'no.h5'",
                    "must be an existing HDF5 file; 'npdr import' makes one of CSV files"}));
  EXPECT_TRUE(says(
      problems_of(kStudyText, {"method.training.batch_size=1000"}),
      {"--set method.training.batch_size=1000: method.training.batch_size = 1000", "must be <= 171",
       "\n--set method.training.batch_size=1000: method.training.batch_size = 1000",
       "must be <= 855"}));
}

TEST(StudyProblems, OverridesThatCantBeReadSaySo) {
  EXPECT_TRUE(says(problems_of(kStudyText, {"shard_size"}),
                   {"--set shard_size:", "must be one line of the form key=value"}));
  for (const std::string key : {"#x", "[a]#", "[[method]]#", "study.name#"}) {
    EXPECT_TRUE(says(problems_of(kStudyText, {key + "=1"}),
                     {"--set " + key + "=1: '" + key + "' isn't a dotted key"}));
  }
  EXPECT_TRUE(says(problems_of(kStudyText, {"a=1\nb=2"}),
                   {"--set a=1", "\nb=2:", "must be one line of the form key=value"}));
  EXPECT_TRUE(says(
      problems_of(kStudyText, {"method.NPDR (MAF).num_rounds=2"}),
      {"--set method.NPDR (MAF).num_rounds=2: 'method.NPDR (MAF).num_rounds' isn't a dotted key",
       "quote names with other characters than letters, digits, '_' and '-'"}));
  EXPECT_EQ(problems_of(kStudyText, {"prior.pole_mass={uniform=[1,2]"}),
            "--set prior.pole_mass={uniform=[1,2]: Error while parsing inline table: encountered "
            "end-of-file");
  EXPECT_TRUE(
      says(problems_of(kStudyText, {"method.\"NPDR (MOG)\".num_rounds=2"}),
           {"--set method.\"NPDR (MOG)\".num_rounds=2: unknown method or table of one 'NPDR (MOG)'",
            "'NPDR (MoG)'", "known: embedding"}));
  EXPECT_TRUE(
      says(problems_of(kStudyText, {"study.name.x=2"}), {"--set study.name.x=2: 'name'", "table"}));
  EXPECT_EQ(problems_of(kStudyText, {"report.title="}),
            "--set report.title=: Error while parsing key-value pair: encountered end-of-file");
}

TEST(StudyProblems, NamesTooLongForTheFileSystemAreNoSurprise) {
  const std::string name(5000, 'a');
  EXPECT_NE(message_of<InputError>([&] { read_study(name); }).find("can't be opened"),
            std::string::npos);
  EXPECT_NE(problems_of(kStudyText, {"target.recording=" + name.substr(0, 4000)})
                .find("must be an existing HDF5 file"),
            std::string::npos);
}

TEST(StudyProblems, ACsvFileIsNoRecordingYet) {
  const TempFolder folder;
  const std::string csv = folder.file("run.csv", "t [s],theta [rad]\n").string();
  EXPECT_TRUE(says(problems_of(kStudyText, {"target.recording=" + csv}),
                   {"--set target.recording", "run.csv', must be an existing HDF5 file",
                    "'npdr import' makes one of CSV files"}));
}

TEST(StudyProblems, ReferencesAndHeldOutRolloutsAreChecked) {
  const auto with = [](const std::string& tables) {
    return problems_of(std::string(kStudyText) + "\n" + tables);
  };
  EXPECT_EQ(with("[[reference]]\nname = 'a'\nparameters = { pole_mass = 1.3 }"), "");
  EXPECT_TRUE(says(with("[[reference]]\nname = 'truth'"),
                   {"s.toml:24:8: reference.name = 'truth'", "must be unlike",
                    "'prior', 'nominal', 'truth' and 'floor'"}));
  EXPECT_NE(with("[[reference]]\nname = 'npdr maf'").find("must be unlike"), std::string::npos);
  EXPECT_TRUE(says(with("[[reference]]\nname = 'a'\nparameters = { pole_mas = 1.3 }"),
                   {"s.toml:25:27: reference.parameters: unknown parameter 'pole_mas'",
                    "'pole_mass'", "known: pole_mass"}));
  EXPECT_EQ(with("[reference]\nname = 'a'"), "s.toml:23:1: must be made of [[reference]] tables");
  EXPECT_TRUE(says(problems_of(kStudyText, {"evaluate.metrics=['final_error']"}),
                   {"--set evaluate.metrics=['final_error']: evaluate.metrics = 'final_error'",
                    "must be left out", "'pendulum'"}));
  EXPECT_TRUE(
      says(problems_after("name = \"pendulum\"", "name = 'pendulum'\nminigolf = { substeps = 3 }"),
           {"s.toml:10:12: simulator.minigolf", "must be left out", "'pendulum'"}));
  EXPECT_TRUE(says(problems_of(kStudyText, {"simulator.minigolf.substeps=3"}),
                   {"--set simulator.minigolf.substeps=3: simulator.minigolf", "must be left out",
                    "'pendulum'"}));
  EXPECT_TRUE(says(problems_of(kStudyText, {"target.held_out=-1"}),
                   {"--set target.held_out=-1: target.held_out = -1", "must be >= 0 and <= 10^9"}));
  EXPECT_NE(problems_of(kStudyText, {"target.rollouts=[1, 0]"})
                .find("target.rollouts = [1, 0], must be distinct and >= 1"),
            std::string::npos);
  EXPECT_TRUE(says(problems_of(kStudyText, {"target.rollouts=[2, 1]"}),
                   {"--set target.rollouts=[2, 1]: target.rollouts", "must be left out"}));
  EXPECT_TRUE(says(problems_of(kStudyText, {"evaluate.leave_out=1"}),
                   {"--set evaluate.leave_out=1: evaluate.leave_out = 1", "must be 0 or >= 2"}));
}

TEST(StudyProblems, ChecksAreKnownAndDistinct) {
  const auto problem = [](const std::string& table) {
    return problems_of(std::string(kStudyText) + "[diagnose]\n" + table + "\n");
  };
  const std::string all =
      "distinct, each one of sbc, coverage, tarp, local_c2st, predictive, ood, "
      "failures, training, sampling, residuals, bounds, contraction, fit, held_out";
  EXPECT_NE(problem("checks = ['sbc', 'sbc']").find(all), std::string::npos);
  EXPECT_NE(problem("checks = ['rank']").find(all), std::string::npos);
  EXPECT_NE(problem("num_simulations = 39").find("diagnose.num_simulations = 39"),
            std::string::npos);
  EXPECT_NE(problem("alpha = 0.0").find("diagnose.alpha = 0.0"), std::string::npos);
  EXPECT_NE(problem("sample = 3").find("diagnose"), std::string::npos);
}

TEST(StudyProblems, AnObservationCantBeJudgedByAFewSimulations) {
  const std::string few = edited(kStudyText, "num_simulations = 200",
                                 "num_simulations = 30\ntraining = { batch_size = 10 }");
  EXPECT_EQ(problems_of(few + "[diagnose]\nchecks = ['sbc']\n"), "");
  EXPECT_NE(problems_of(few + "[diagnose]\n")
                .find("method.num_simulations = 30, must be such that all rounds have 40 or more "
                      "with the check 'ood'"),
            std::string::npos);
}

TEST(StudyProblems, ATableOfChecksMeansAllOfThem) {
  const auto checks = [](const std::string& text) {
    return parse_study(kStudyText + text, "s.toml", {}).diagnose.checks.size();
  };
  EXPECT_EQ(checks("[diagnose]\n"), 12u);
  EXPECT_EQ(checks("[diagnose]\nchecks = ['sbc']\n"), 1u);
  EXPECT_EQ(checks("[diagnose]\nchecks = []\n"), 0u);
}

// Calibration is among them where its 300 simulations are at most a quarter of each method's.
TEST(StudyProblems, WithoutATableStudiesAreCheckedByWhatCostsLittle) {
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
  EXPECT_EQ(problems_of(edited(kStudyText, "num_simulations = 200",
                               "num_simulations = 30\ntraining = { batch_size = 10 }")),
            "");
}

}  // namespace
}  // namespace npdr::pipeline
