// Lists of commands for batch systems of every kind, and the task that runs one of them.
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Tasks : public SmallStudyTest {};

std::size_t num_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(Tasks, AreWhatCanBeMadeNow) {
  const Outcome first = npdr(0, {"tasks", "small.toml"});
  EXPECT_TRUE(has(first.out, "npdr-propose small.toml"));
  EXPECT_FALSE(has(first.out, "npdr-simulate")) << "needs the proposals first";
  npdr(0, {"run", "small.toml", "--until", "propose"});
  const std::vector<std::string> small_shards = {
      "tasks", "small.toml", "--set", "simulate.shard_size=40", "--until", "simulate"};
  const Outcome shards = npdr(small_shards);
  EXPECT_TRUE(has(shards.out, {"--shard 0", "--shard 3"}));
  const Outcome packed = npdr(joined(small_shards, {"--shards-per-task", "3"}));
  EXPECT_EQ(num_lines(packed.out), num_lines(shards.out) / 2) << "4 shards in 2 tasks";
}

TEST_F(Tasks, WaveByWaveGiveTheBitsOfARun) {
  const ProgramsOnPath path;
  const std::string waves = NPDR_SOURCE_DIR "/jobs/waves.sh";
  with_status(0, run(folder_.path(), {waves, "small.toml", "--work", "waves"}));
  EXPECT_EQ(npdr({"tasks", "small.toml", "--work", "waves"}).out, "") << "all is done";
  npdr(0, {"run", "small.toml"});
  EXPECT_EQ(digests(folder_ / "waves/small"), digests(folder_ / "runs/small"));
}

// Simulations of 150 and of 300 rows, in shards of 50.
TEST_F(Tasks, SimulationsMayHaveDifferentNumbersOfShards) {
  const std::vector<std::string> settings = {"small.toml", "--set", "simulate.shard_size=50",
                                             "--set", "method.\"NPDR (MoG)\".num_simulations=300"};
  npdr(0, joined({"run", "--until", "propose"}, settings));
  const auto simulate = [&](const std::string& round, const std::vector<std::string>& more) {
    const std::vector<std::string> words = {"npdr-simulate", "--round", round};
    return run(folder_.path(), joined(joined(words, settings), more));
  };
  // An array that is submitted again: what shard 3 belongs to is there, what isn't has no such
  // shard.
  with_status(0, simulate("1", {"--only", "NPDR (MoG)"}));
  with_status(0, simulate("1", {"--shard", "3"}));
  std::filesystem::remove_all(folder_ / "runs/.cache/simulate");
  for (const char* shards : {"0-2", "3-5"}) with_status(0, simulate("1", {"--shard", shards}));
  EXPECT_FALSE(has(npdr(joined({"status"}, settings)).out, "shards")) << "all are there";
  EXPECT_TRUE(has(with_status(2, simulate("2", {"--shard", "6"})).err, "has shards 0 to "));
}

TEST_F(Tasks, TakeWhatTheyRunAlongWhenTheyAreKilled) {
  npdr(0, {"run", "small.toml", "--until", "simulate"});
  const Program task(folder_.path(),
                     {"npdr", "task", "--", NPDR_BINARY_DIR "/bin/npdr", "run", "small.toml",
                      "--until", "infer", "--set", "method.training.max_epochs=1000000", "--set",
                      "method.training.stop_after_epochs=1000000"});
  // The run's own children are there only after it has begun to listen.
  pid_t child = 0;
  ASSERT_TRUE(comes_true([&] {
    const std::vector<pid_t> children = task.children();
    if (children.empty()) return false;
    child = children.front();
    const std::string pid = std::to_string(child);
    std::ifstream grandchildren("/proc/" + pid + "/task/" + pid + "/children");
    return std::istream_iterator<pid_t>(grandchildren) != std::istream_iterator<pid_t>();
  }));
  task.send(SIGKILL);
  task.wait();
  EXPECT_TRUE(comes_true([&] { return has_ended(child); }));
}

}  // namespace
}  // namespace npdr::pipeline
