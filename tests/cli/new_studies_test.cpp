/// What 'npdr new' writes.
#include "pipeline/artefacts/recording.h"
#include "tests/cli/own_simulator.h"
#include "tests/device_recordings.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

class NewStudies : public OwnSimulators {
 protected:
  // The text of a new study, which is valid.
  std::string new_study(const std::string& name, const std::vector<std::string>& words) const {
    npdr(0, joined({"new", name}, words));
    npdr(0, {"validate", name + ".toml"});
    return text_of(folder_ / (name + ".toml"));
  }
};

TEST_F(NewStudies, FitWhatTheyAreFor) {
  copy_example("spring");
  compile_spring(folder_.path());
  new_study("mine", {"--library", "spring.so"});
  new_study("swing", {"--simulator", "pendulum"});
  npdr(0, {"new", "arm", "--simulator", "furuta"});
  EXPECT_FALSE(has(text_of(folder_ / "arm.toml"), "[0.0, 0.0]")) << "no range";
  for (const char* option : {"--worker", "--command"}) {
    EXPECT_TRUE(has(
        npdr(0, {"new", std::string("by") + option, option, "python3 \"my sim\".py"}).out, "EDIT"));
    const std::string study = std::string("by") + option + ".toml", text = text_of(folder_ / study);
    EXPECT_TRUE(has(npdr(0, {"validate", study}).out,
                    "\nstill marked EDIT, as npdr new wrote: lines 8, 12, "));
    EXPECT_TRUE(has(text, "shard_size = 200"));
  }
  npdr(2, {"new", "both", "--worker", "a", "--library", "b"});
  npdr(2, {"new", "none", "--recording", "gone.h5"});
  EXPECT_EQ(npdr({"new", "mine", "--library", "spring.so"}).status, 2) << "it is there already";
}

TEST_F(NewStudies, TakeADataset) {
  std::ofstream theta(folder_ / "theta.csv"), x(folder_ / "x.csv");
  theta << "k [N/m],m,g,rate\n";
  x << "peak,mean\n";
  for (int i = 0; i <= 100; ++i) {
    theta << 10.0 + 0.2 * i << "," << (i == 100 ? "6.123456789" : fmt::format("{}", 2.0 + 0.04 * i))
          << ",7," << std::pow(10.0, i / 50.0) << "\n";
    x << i << "," << -i << "\n";
  }
  theta.close();
  x.close();
  folder_.file("x_o.csv", "peak,mean\n50,-50\n");
  npdr(0, {"import", "--theta", "theta.csv", "--x", "x.csv", "-o", "d.h5"});
  EXPECT_TRUE(has(new_study("finished", {"--dataset", "d.h5"}),
                  {"dataset = \"d.h5\"", "k = { uniform = [9.9, 30.1] }  # [N/m]",
                   "m = { uniform = [1.979, 6.144] }", "# g = { uniform = [7.0, 7.0] }",
                   "rate = { log_uniform = [0.977, 102.3] }", "num_simulations = 101"}));
  EXPECT_FALSE(has(npdr(0, {"run", "finished.toml", "--until", "simulate"}).err, "failed"));
  EXPECT_TRUE(has(npdr({"new", "both", "--dataset", "d.h5", "--recording", "d.h5"}).err,
                  "--dataset can't go with --recording"));
}

TEST_F(NewStudies, TakeAnObservation) {
  folder_.file("x_o.csv", "peak,mean\n50,-50\n");
  npdr(0, {"new", "seen", "--observation", "x_o.csv", "--command", "sim"});
  EXPECT_TRUE(has(text_of(folder_ / "seen.toml"), "observation = \"x_o.csv\"\n"));
  EXPECT_TRUE(has(npdr(0, {"validate", "seen.toml"}).out, "2 features each"));
  EXPECT_TRUE(says(npdr({"new", "a", "--observation", "x_o.csv", "--worker", "sim"}).err,
                   {"npdr new: --observation goes with --command or --dataset"}));
  folder_.file("x_o.csv", "peak\nhigh\n");
  EXPECT_TRUE(says(npdr({"new", "b", "--observation", "x_o.csv", "--command", "sim"}).err,
                   {"npdr new: x_o.csv:2: column 1 'peak' = 'high', must be a number"}));
}

TEST_F(NewStudies, QuoteNamesThatNeedIt) {
  copy_example("spring");
  folder_.file("spring.c", edited(text_of(folder_ / "spring.c"), "\"stiffness\"", "\"k (all)\""));
  compile_spring(folder_.path());
  EXPECT_TRUE(has(new_study("odd", {"--library", "spring.so"}), "\n\"k (all)\" = { uniform"));
}

TEST_F(NewStudies, TakeARecording) {
  write_recording(furuta_recording(4), folder_ / "recorded.h5");
  const std::string text =
      new_study("real", {"--recording", "recorded.h5", "--simulator", "furuta"});
  EXPECT_TRUE(has(text, {"recording = \"recorded.h5\"", "held_out = ", "num_rollouts = 3",
                         "embedding = { downsample = ", "scale_prior = [0.1, 1.0]"}));
  std::string refined = text.substr(text.find("# [[method]]"));
  for (std::size_t at; (at = refined.find("# ")) != std::string::npos;) refined.erase(at, 2);
  folder_.file("refined.toml", text + refined);
  npdr(0, {"validate", "refined.toml"});
  EXPECT_TRUE(has(refined, "cross_validate = true"));
  npdr(2, {"new", "other", "--recording", "recorded.h5", "--simulator", "pendulum"});
}

TEST_F(NewStudies, TakeAModelOfMujoco) {
  if (!fs::exists(NPDR_BINARY_DIR "/lib/npdr_mujoco.so")) GTEST_SKIP() << "no MuJoCo";
  copy_example("cartpole");
  new_study("pole", {"--mjcf", "cartpole.xml"});
}

}  // namespace
}  // namespace npdr::pipeline
