// Problems of methods: place, value and what is allowed are what users must be told.
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::string kMaf = "num_simulations = 200";

TEST(MethodProblems, MethodsFitTheStudy) {
  EXPECT_TRUE(says(problems_after("NPDR (MoG)", "NPDR (MAF)"),
                   {"s.toml:20:8: method.name = 'NPDR (MAF)'", "must be unique"}));
  EXPECT_TRUE(
      says(problems_after("NPDR (MoG)", "npdr [maf]"),
           {"s.toml:20:8: method.name = 'npdr [maf]'",
            "must be different from 'NPDR (MAF)' in its letters a-z and digits", "'npdr-maf'"}));
  EXPECT_TRUE(
      says(problems_after(kMaf, "num_rollouts = 6"),
           {"s.toml:17:16: method.num_rollouts = 6", "must be <= target.num_rollouts = 5"}));
  EXPECT_TRUE(says(problems_after(kMaf, "embedding = { channels = ['theta', 'thet_dot'] }"),
                   {"s.toml:17:26: method.embedding.channels: unknown channel 'thet_dot'",
                    "'theta_dot'", "known: theta"}));
  EXPECT_TRUE(says(problems_of(edited(edited(kStudyText, kMaf, "embedding = { downsample = 3 }"),
                                      "\"pendulum\"", "\"pendulum\"\nstore_every = 2")),
                   {"s.toml:18:28: method.embedding.downsample = 3",
                    "must be a multiple of simulator.store_every = 2"}))
      << "the other method leaves it out: it sees all states that are stored";
  EXPECT_TRUE(
      says(problems_after(kMaf, "published.rms = { mean = 1.0 }"),
           {"s.toml:17:17: method.published: unknown metric 'rms'", "'rmse'", "known: dtw"}));
}

TEST(MethodProblems, SaySomethingOfTheAlgorithmThatASettingIsFor) {
  EXPECT_TRUE(says(problems_after(kMaf, "refine = { min_ess = 200 }"),
                   {"s.toml:17:10: method.refine must be left out: it means nothing to the "
                    "algorithm 'npe_nle', which a method has that names none; 'refine' reads it"}));
}

TEST(MethodProblems, TrainingFitsTheNumberOfSimulations) {
  EXPECT_EQ(problems_after(kMaf, "num_simulations = 50"), "") << "the default is 43 then";
  EXPECT_TRUE(says(problems_after(kMaf, "num_simulations = 50\ntraining.batch_size = 46"),
                   {"s.toml:18:23: method.training.batch_size = 46", "must be <= 43"}));
  EXPECT_EQ(problems_after(kMaf, "num_simulations = 56"), "");
  EXPECT_EQ(problems_after(kMaf, "num_simulations = 3\ntraining.batch_size = 2"),
            "s.toml:17:19: method.num_simulations = 3, must be >= 4, 2 each for training and for "
            "validation");
  EXPECT_TRUE(
      says(problems_after(kMaf, "num_simulations = 7\nnum_atoms = 2\ntraining.batch_size = 2"),
           {"s.toml:19:1: method.training.validation_fraction = 0.1",
            "must be such that 2 or more of the 7 simulations of a round are left for training and "
            "for validation each"}));
  // A twentieth chooses the powers of a pool.
  EXPECT_TRUE(says(problems_after(kMaf,
                                  "num_simulations = 20\nembedding.kind = 'all_steps'\n"
                                  "training.batch_size = 2"),
                   {"s.toml:19:1: method.training.validation_fraction = 0.1",
                    "2 or more of the 19 simulations of a round"}));
  EXPECT_TRUE(says(problems_after(kMaf, "num_atoms = 11\ntraining = { batch_size = 10 }"),
                   {"s.toml:17:13: method.num_atoms = 11", "must be <= training.batch_size = 10"}));
  EXPECT_TRUE(says(problems_after(kMaf, "loss = 'analytic'"),
                   {"s.toml:17:8: method.loss = 'analytic'",
                    "must be 'auto' or 'atomic' with density_estimator.kind = 'nsf'", "'mdn'"}));
}

TEST(MethodProblems, RefinementNeedsADensityOfTheNoise) {
  const std::string refine = "algorithm = \"refine\"";
  EXPECT_TRUE(says(problems_after(kMaf, refine),
                   {"s.toml:17:13: algorithm 'refine' needs [observation_noise]",
                    "give scale, scale_prior or std"}));
  const std::string noisy =
      edited(kStudyText, "[simulator]", "[observation_noise]\nscale = 0.1\n[simulator]");
  const std::string in_part =
      edited(kStudyText, "[simulator]", "[observation_noise]\nstd = { theta = 0.1 }\n[simulator]");
  EXPECT_TRUE(
      says(problems_of(edited(in_part, kMaf, refine)),
           {"s.toml:9:7: observation_noise.std = without theta_dot, must be of all channels",
            "'refine' needs noise in each"}));
  const std::string none_of_theta =
      edited(kStudyText, "[simulator]",
             "[observation_noise]\nscale = 0.1\nstd = { theta = 0.0 }\n[simulator]");
  EXPECT_TRUE(
      says(problems_of(edited(none_of_theta, kMaf, refine)),
           {"s.toml:10:17: observation_noise.std.theta = 0, must be > 0: algorithm 'refine' "
            "needs noise in each channel"}));
  const auto problems = [&](const std::string& settings) {
    return problems_of(edited(noisy, kMaf, refine + "\nrefine = { " + settings + " }"));
  };
  EXPECT_EQ(problems("level_size = 1000"), "");
  EXPECT_TRUE(says(problems("max_simulations = 5000"),
                   {"s.toml:20:30: method.refine.max_simulations = 5000",
                    "must be >= 3 times "
                    "refine.level_size = 10000"}));
  EXPECT_TRUE(says(problems("level_size = 500"),
                   {"s.toml:20:25: method.refine.level_size = 500", "must be >= 1000"}));
  EXPECT_TRUE(says(problems("level_size = 1000, max_simulations = 1000000000"),
                   {"s.toml:20:49: method.refine.max_simulations = 1000000000",
                    "must be at most 10000 times refine.level_size = 1000"}));
  EXPECT_TRUE(says(problems("likelihood_power = 1.5"),
                   {"s.toml:20:31: method.refine.likelihood_power = 1.5", "must be > 0 and <= 1"}));
  EXPECT_TRUE(
      says(problems("start = 'NPDR (MOG)'"),
           {"s.toml:20:20: method.refine.start: unknown method", "'NPDR (MOG)'", "'NPDR (MoG)'"}));
}

TEST(MethodProblems, OnlyTheAtomicLossHasAtoms) {
  const std::string mog = "density_estimator = { kind = \"mog\" }";
  const std::string small = "\nnum_atoms = 11\ntraining = { batch_size = 10 }";
  EXPECT_EQ(problems_after(mog, mog + small), "");
  EXPECT_EQ(problems_after(mog, mog + "\nloss = 'analytic'" + small), "");
  EXPECT_TRUE(says(problems_after(mog, mog + "\nloss = 'atomic'" + small),
                   {"s.toml:23:13: method.num_atoms = 11", "must be <= training.batch_size = 10"}));
}

TEST(MethodProblems, AlgorithmsHaveNetworksAndEmbeddingsThatSuitThem) {
  EXPECT_TRUE(
      says(problems_after(kMaf, "algorithm = 'npe_a'\ndensity_estimator = { kind = 'maf' }"),
           {"s.toml:18:30: method.density_estimator.kind = 'maf'",
            "must be one of mdn with algorithm 'npe_a'"}));
  EXPECT_TRUE(says(problems_after(kMaf, "algorithm = 'nle'\nembedding = { kind = 'linear' }"),
                   {"s.toml:18:22: method.embedding.kind = 'linear'",
                    "must be another with algorithm 'nle'", "'all_steps'"}));
  EXPECT_EQ(problems_after(kMaf, "algorithm = 'nre_b'\nembedding = { kind = 'bayessim' }"), "");
  EXPECT_TRUE(says(problems_after(kMaf, "sampler = { thin = 3 }"),
                   {"s.toml:17:11: method.sampler", "must be left out", "'npe_nle'"}));
  EXPECT_TRUE(says(problems_after(kMaf,
                                  "algorithm = 'nre_b'\nembedding = { kind = 'bayessim' }\n"
                                  "num_atoms = 51"),
                   {"s.toml:19:13: method.num_atoms = 51", "must be <= training.batch_size = 50"}));
}

TEST(StudyReader, PopulationsOfSmcAreHalvedUnlessAStudySaysOtherwise) {
  const auto quantile = [](const std::string& method) {
    return parse_study(edited(kStudyText, kMaf, method), "s.toml", {}).methods[0].abc.quantile;
  };
  EXPECT_EQ(quantile("algorithm = 'abc_smc'"), 0.5);
  EXPECT_EQ(quantile("algorithm = 'abc_smc'\nabc.quantile = 0.2"), 0.2);
  EXPECT_EQ(quantile("algorithm = 'abc_rejection'\nnum_rounds = 1"), 0.1);
}

TEST(StudyReader, TheAlgorithmFollowsFromSettingsUnlessAStudySaysIt) {
  using inference::Algorithm;
  const auto algorithm = [](const std::string& method) {
    return parse_study(edited(kStudyText, kMaf, method), "s.toml", {}).methods[0].algorithm.kind;
  };
  EXPECT_EQ(algorithm(kMaf), Algorithm::npe_nle);
  EXPECT_EQ(algorithm("num_rounds = 2"), Algorithm::npe_nle);
  EXPECT_EQ(algorithm("num_atoms = 5"), Algorithm::npe_c);
}

TEST(MethodProblems, MethodsWithoutANetworkHaveKeysOfTheirOwn) {
  EXPECT_EQ(problems_after(kMaf, "algorithm = 'abc'\nabc = { quantile = 0.02 }"), "");
  EXPECT_TRUE(says(problems_after(kMaf, "algorithm = 'abc'\nabc = { quantile = 0 }"),
                   {"s.toml:18:20: method.abc.quantile = 0", "must be > 0 and <= 1"}));
  EXPECT_TRUE(says(problems_after(kMaf, "algorithm = 'abc'\nabc = { distance = 'dwt' }"),
                   {"s.toml:18:20: method.abc.distance = 'dwt'",
                    "must be one of euclidean, dtw, rmse", "'dtw'"}));
  EXPECT_TRUE(
      says(problems_after(kMaf, "algorithm = 'abc'\nnum_rounds = 2"),
           {"s.toml:18:14: method.num_rounds = 2", "must be 1 with algorithm 'abc_rejection'"}));
  EXPECT_TRUE(
      says(problems_after(kMaf, "algorithm = 'mcmc_abc'"),
           {"s.toml:15:1: method.num_rounds = 1", "must be >= 2 with algorithm 'abc_mcmc'"}));
  EXPECT_TRUE(says(problems_after(kMaf, "algorithm = 'smc_abc'\nembedding = { kind = 'linear' }"),
                   {"s.toml:18:22: method.embedding.kind = 'linear'",
                    "must be another with algorithm 'abc_smc'", "'all_steps'"}));
  EXPECT_TRUE(says(problems_after(kMaf, "algorithm = 'blr'"),
                   {"s.toml:17:13: algorithm 'linear_regression'", "simulator.name = 'furuta'",
                    "found 'pendulum'"}));
}

TEST(MethodProblems, SettingsOfOtherAlgorithmsMustBeLeftOut) {
  EXPECT_TRUE(says(problems_after(kMaf, "algorithm = 'abc'\ntraining = { batch_size = 10 }"),
                   {"s.toml:18:12: method.training", "must be left out", "'abc_rejection'"}));
  EXPECT_TRUE(says(problems_after(kMaf, "abc = {}"),
                   {"s.toml:17:7: method.abc", "must be left out", "'npe_nle'"}));
  // One for all methods may be meant for the others.
  EXPECT_EQ(problems_of(edited(kStudyText, kMaf, "algorithm = 'abc'"),
                        {"method.training.batch_size=10", "method.abc.quantile=0.2"}),
            "");
}

std::string problems_of_furuta(const std::string& prior, const std::string& method) {
  std::string text = edited(kStudyText, "pendulum", "furuta");
  text = edited(text, "{ pole_mass = 1.1 }", "{}");
  text = edited(text,
                "pole_mass = { uniform = [0.3, 1.7] }\n"
                "pole_length = { log_uniform = [0.3, 1.7] }",
                prior);
  return problems_of(edited(text, kMaf, "algorithm = 'linear_regression'\n" + method));
}

TEST(MethodProblems, RegressionsNeedWhatTheyIdentify) {
  const std::string pole = "pole_mass = { uniform = [0.01, 0.03] }";
  EXPECT_EQ(problems_of_furuta(pole, ""), "");
  EXPECT_TRUE(
      says(problems_of_furuta(pole, "linear_regression.window = 6"),
           {"s.toml:17:28: method.linear_regression.window = 6", "must be odd, >= 5 and <= 1001"}));
  EXPECT_TRUE(says(problems_of_furuta("gravity = { uniform = [9.0, 10.0] }", ""),
                   {"s.toml:16:13: algorithm 'linear_regression' identifies rotary_damping, "
                    "pole_damping, rotary_mass, pole_mass, rotary_length, pole_length",
                    "the prior must have one of them at least"}));
  EXPECT_TRUE(says(problems_of_furuta(pole, "num_rounds = 3"),
                   {"s.toml:17:14: method.num_rounds", "must be left out", "'linear_regression'"}));
}

}  // namespace
}  // namespace npdr::pipeline
