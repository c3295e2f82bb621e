// Lists of commands for batch systems of every kind, and the task that runs one of them.
#include <cstdlib>

#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Tasks : public SmallStudyTest {};

// Puts the programs on the PATH as long as it lives.
class ProgramsOnPath {
 public:
  ProgramsOnPath() : before_(std::getenv("PATH")) {
    setenv("PATH", (NPDR_BINARY_DIR "/bin:" + before_).c_str(), 1);
  }
  ~ProgramsOnPath() { setenv("PATH", before_.c_str(), 1); }
  ProgramsOnPath(const ProgramsOnPath&) = delete;
  ProgramsOnPath& operator=(const ProgramsOnPath&) = delete;

 private:
  std::string before_;
};

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
  std::vector<std::string> packed = small_shards;
  packed.insert(packed.end(), {"--shards-per-task", "3"});
  EXPECT_EQ(num_lines(npdr(packed).out), num_lines(shards.out) / 2) << "4 shards in 2 tasks";
}

TEST_F(Tasks, WaveByWaveGiveTheBitsOfARun) {
  const ProgramsOnPath path;
  const std::string waves = NPDR_SOURCE_DIR "/jobs/waves.sh";
  const Outcome outcome = run(folder_.path(), {waves, "small.toml", "--work", "waves"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(npdr({"tasks", "small.toml", "--work", "waves"}).out, "") << "all is done";
  npdr(0, {"run", "small.toml"});
  EXPECT_EQ(digests(folder_ / "waves/small"), digests(folder_ / "runs/small"));
}

// Simulations of 150 and of 300 rows, in shards of 50.
TEST_F(Tasks, SimulationsMayHaveDifferentNumbersOfShards) {
  const std::vector<std::string> settings = {"small.toml", "--set", "simulate.shard_size=50",
                                             "--set", "method.\"NPDR (MoG)\".num_simulations=300"};
  const auto call = [&](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), settings.begin(), settings.end());
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_.path(), words);
  };
  ASSERT_EQ(call({"npdr", "run"}, {"--until", "propose"}).status, 0);
  // An array that is submitted again: what shard 3 belongs to is there, what isn't has no such
  // shard.
  ASSERT_EQ(call({"npdr-simulate"}, {"--round", "1", "--only", "NPDR (MoG)"}).status, 0);
  EXPECT_EQ(call({"npdr-simulate"}, {"--round", "1", "--shard", "3"}).status, 0);
  std::filesystem::remove_all(folder_ / "runs/.cache/simulate");
  for (const char* shards : {"0-2", "3-5"}) {
    const Outcome outcome = call({"npdr-simulate"}, {"--round", "1", "--shard", shards});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
  const Outcome status = call({"npdr", "status"}, {});
  EXPECT_FALSE(has(status.out, "shards")) << "all are there:\n";
  const Outcome none = call({"npdr-simulate"}, {"--round", "2", "--shard", "6"});
  EXPECT_EQ(none.status, 2);
  EXPECT_TRUE(has(none.err, "has shards 0 to "));
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
