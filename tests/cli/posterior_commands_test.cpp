#include <cmath>
#include <functional>

#include "pipeline/artefacts/recording.h"
#include "tests/cli/study_run.h"

namespace npdr::pipeline {
namespace {

class PosteriorCommands : public SmallRun {};

TEST_F(PosteriorCommands, SampleAndLogProbUseAPosterior) {
  const std::string posterior = "runs/small/npdr-maf/seed-1/round-2/infer.h5";
  const Outcome samples = npdr(0, {"sample", posterior, "-n", "20"});
  EXPECT_EQ(samples.out.substr(0, samples.out.find('\n')), "pole_mass [kg],pole_length [m]");
  EXPECT_EQ(std::count(samples.out.begin(), samples.out.end(), '\n'), 21);
  std::ofstream(file("theta.csv")) << samples.out;
  const Outcome densities = npdr(0, {"log-prob", posterior, "theta.csv"});
  EXPECT_EQ(std::count(densities.out.begin(), densities.out.end(), '\n'), 21);
  EXPECT_FALSE(has(densities.out, "inf"));
  const std::string rows = samples.out.substr(samples.out.find('\n') + 1);
  std::ofstream(file("plain.csv")) << rows;
  EXPECT_EQ(npdr({"log-prob", posterior, "plain.csv"}).out, densities.out);
  std::ofstream(file("one.csv")) << "1\n2\n";
  EXPECT_TRUE(says(
      npdr({"log-prob", posterior, "one.csv"}).err,
      {"npdr log-prob: one.csv: 1 column without names", "must be 2, one for each parameter"}));
  std::ofstream(file("grams.csv")) << "pole_mass [g],pole_length [m]\n1000,1\n";
  EXPECT_TRUE(says(npdr(2, {"log-prob", posterior, "grams.csv"}).err,
                   {"npdr log-prob: grams.csv: column 'pole_mass' is in [g]", "must be in [kg]"}));
}

TEST_F(PosteriorCommands, AreAboutTheOtherParametersOfThoseGiven) {
  const std::string posterior = "runs/small/npdr-maf/seed-1/round-2/infer.h5";
  const Outcome samples = npdr(0, {"sample", "--given", "pole_mass=1.1", posterior, "-n", "20"});
  EXPECT_TRUE(samples.out.starts_with("pole_length [m]\n")) << samples.out;
  std::ofstream(file("lengths.csv")) << samples.out;
  const Outcome densities =
      npdr(0, {"log-prob", posterior, "--given", "pole_mass=1.1", "lengths.csv"});
  EXPECT_EQ(std::count(densities.out.begin(), densities.out.end(), '\n'), 21);
  for (const auto& [given, said] : std::vector<std::pair<std::string, std::string>>{
           {"pole_mass", "--given 'pole_mass': must be NAME=NUMBER"},
           {"pole_mass=nan", "--given 'pole_mass=nan': must be NAME=NUMBER"},
           {"pole_mas=1", "unknown parameter 'pole_mas' (did you mean 'pole_mass'?)"}}) {
    EXPECT_TRUE(has(npdr(2, {"sample", posterior, "--given", given}).err, said));
  }
}

TEST_F(PosteriorCommands, SamplesOfAStudyArePooledOverItsSeeds) {
  const std::vector<std::string> words = {"sample",     "small.toml", "--method",
                                          "NPDR (MoG)", "-n",         "6"};
  const Outcome samples = npdr(0, words);
  const Outcome one = npdr({"sample", "runs/small/npdr-mog/seed-1/round-2/infer.h5", "-n", "6"});
  EXPECT_EQ(samples.out, one.out) << "of its one seed";
  EXPECT_TRUE(has(npdr(2, {"sample", "small.toml"}).err,
                  "2 methods have posteriors (NPDR (MAF), NPDR (MoG)), must be one: choose it by "
                  "--method"));
  const std::vector<std::string> two = joined(words, {"--set", "study.seeds=[1, 2]"});
  EXPECT_TRUE(has(npdr(two).err,
                  "infer NPDR (MoG), seed 2, round 2: isn't there yet; run it first: "
                  "npdr run small.toml"));
  EXPECT_EQ(npdr(joined(two, {"--seeds", "1"})).out, one.out);
}

TEST_F(PosteriorCommands, DensitiesOfAStudyAreTheMeanOverItsSeeds) {
  const auto with_seeds = [&](const std::vector<std::string>& words) {
    return npdr(0, joined(words, {"--set", "study.seeds=[1, 2]"})).out;
  };
  const std::string only = with_seeds({"run", "small.toml", "--only", "NPDR (MAF)"});
  EXPECT_TRUE(only.ends_with("all again: npdr run small.toml --set 'study.seeds=[1, 2]'\n"))
      << only;
  const auto samples = [&](const std::vector<std::string>& words) {
    return with_seeds(joined({"sample", "small.toml", "--method", "NPDR (MAF)"}, words));
  };
  const std::string of_first = samples({"-n", "1", "--seeds", "1"}),
                    of_second = samples({"-n", "1", "--seeds", "2"});
  const std::string pooled = samples({"-n", "2"});
  EXPECT_TRUE(pooled.starts_with(of_first)) << pooled;
  const std::size_t line = of_second.find('\n') + 1;
  EXPECT_FALSE(has(pooled, of_second.substr(line))) << "each has random numbers of its own";
  std::ofstream(file("center.csv")) << "1,1\n9,9\n";
  const std::vector<std::string> log_prob = {"log-prob", "small.toml", "center.csv", "--method",
                                             "NPDR (MAF)"};
  const auto of_seed = [&](const std::string& seed) {
    return with_seeds(joined(log_prob, {"--seeds", seed}));
  };
  const auto first = [](const std::string& out) { return std::stod(out.substr(9)); };
  const double mean = 0.5 * (std::exp(first(of_seed("1"))) + std::exp(first(of_seed("2"))));
  const std::string both = with_seeds(log_prob);
  EXPECT_NEAR(first(both), std::log(mean), 1e-9);
  EXPECT_TRUE(both.ends_with("\n-inf\n")) << "outside of the prior: " << both;
  EXPECT_NE(first(of_seed("1")), first(of_seed("2")));
  EXPECT_TRUE(says(npdr(2, {"log-prob", "runs/small/npdr-mog/seed-1/round-2/infer.h5", "center.csv",
                            "--seeds", "2"})
                       .err,
                   {"npdr log-prob: runs/small/npdr-mog/seed-1/round-2/infer.h5: is "
                    "one posterior; --method, --seeds and --set choose among those of a study",
                    "leave them out"}));
}

TEST_F(PosteriorCommands, SampleTakesAnotherRecordingLikeThatOfTheStudy) {
  const std::string posterior = "runs/small/npdr-maf/seed-1/round-2/infer.h5";
  const Target own = read_recording(file("runs/small/target.h5"));
  const auto sample = [&](const std::function<void(Target&)>& change) {
    Target target = own;
    change(target);
    write_recording(target, file("x.h5"));
    return npdr({"sample", posterior, "-n", "3", "--x", "x.h5"});
  };
  EXPECT_EQ(sample([](Target& t) { t.dt *= 1.0005; }).status, 0) << "measured dt differ a little";
  const auto rejected = [&](const std::function<void(Target&)>& change) {
    return with_status(2, sample(change)).err;
  };
  EXPECT_TRUE(says(rejected([](Target& t) { t.dt = 0.01; }),
                   {"npdr sample: x.h5: dt = 0.01 s", "must be 0.02 s", posterior}));
  EXPECT_TRUE(
      says(rejected([](Target& t) {
             t = t.first(1);
             for (Rollout& rollout : t.rollouts) {
               rollout.states.conservativeResize(400, 2);
               rollout.actions.conservativeResize(399, 1);
             }
           }),
           {"npdr sample: x.h5: 1 rollout,", "must be 2", "399 steps", "must be 400", posterior}));
  EXPECT_TRUE(
      says(rejected([](Target& t) { t.state_channels[0].unit = "deg"; }),
           {"npdr sample: x.h5: dataset 'states': channels are theta [deg], theta_dot [rad/s]",
            "must be theta [rad], theta_dot [rad/s]", "convert its columns"}));
  EXPECT_TRUE(says(
      rejected([](Target& t) { t.action_channels[0].label = "force"; }),
      {"npdr sample: x.h5: dataset 'actions': channels are force [N m]", "must be torque [N m]"}));
  const Outcome wider = sample([](Target& t) {
    t.state_channels.push_back({"battery", "V"});
    for (Rollout& rollout : t.rollouts) {
      rollout.states.conservativeResize(Eigen::NoChange, 3);
      rollout.states.col(2).setConstant(12.0);
    }
  });
  EXPECT_EQ(wider.status, 0) << "channels that the posterior doesn't know are left out\n"
                             << wider.err;
  const std::string warning = "has other actions, or begins in other states";
  EXPECT_FALSE(has(wider.err, warning));
  const Outcome pushed = sample([](Target& t) { t.rollouts[1].actions.array() += 0.1; });
  EXPECT_EQ(pushed.status, 0);
  EXPECT_TRUE(has(pushed.err, warning));
  EXPECT_EQ(wider.out, sample([](Target&) {}).out);
}

}  // namespace
}  // namespace npdr::pipeline
