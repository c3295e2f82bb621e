#include "core/shell_call.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"
#include "tests/temp_folder.h"
#include "tests/wait_for.h"

namespace npdr {
namespace {

class ShellCalls : public ::testing::Test {
 protected:
  CallResult call(const std::string& command, double time_limit = 60.0) const {
    return run_shell({command, folder_.path(), {{"NPDR_TEST", "a value"}}, time_limit});
  }

  // Whether the process whose number is in a file of the folder ends.
  bool is_gone(const std::string& file) const {
    const pid_t process = std::stoi(text_of(folder_ / file));
    return comes_true([&] { return has_ended(process); });
  }

  TempFolder folder_;
};

TEST_F(ShellCalls, RunInTheFolderWithTheEnvironment) {
  folder_.file("here.txt", "found\n");
  const CallResult result = call("cat here.txt; echo \"$NPDR_TEST\" >&2; cat");
  EXPECT_TRUE(result.succeeded());
  EXPECT_EQ(result.output, "found\na value\n");
}

TEST_F(ShellCalls, TellHowTheyEnded) {
  EXPECT_EQ(call("exit 3").exit_status, 3);
  EXPECT_EQ(call("nosuchprogram").exit_status, 127);
  const CallResult killed = call("kill -SEGV $$");
  EXPECT_EQ(killed.exit_status, 128 + SIGSEGV);
  EXPECT_TRUE(killed.words(1.0).starts_with("signal 11 (Segmentation fault) after"));
  EXPECT_TRUE(call("exit 3").words(1.0).starts_with("exit status 3 after"));
}

TEST_F(ShellCalls, KeepBeginAndEndOfALongOutput) {
  const CallResult result = call("echo first; yes | head -c 3000000; echo last");
  EXPECT_LT(result.output.size(), 40'000u);
  EXPECT_TRUE(result.output.starts_with("first\n"));
  EXPECT_TRUE(result.output.ends_with("last\n"));
  EXPECT_TRUE(has(result.output, "bytes left out"));
}

TEST_F(ShellCalls, AreEndedAsAGroupAtTheTimeLimit) {
  // The shell itself and what it started both ignore the polite request.
  const CallResult result = call(
      "trap '' TERM; (trap '' TERM; echo $$ > shell; tail -f /dev/null) & tail -f /dev/null", 1.0);
  EXPECT_TRUE(result.timed_out);
  EXPECT_FALSE(result.succeeded());
  EXPECT_EQ(result.words(1.0), "ended after its time limit of 1 s");
  EXPECT_TRUE(is_gone("shell"));
}

// The shell itself ends at once; what it has started has its second. That is still to come when its
// parent has changed and somebody has read more than a pipe holds.
TEST_F(ShellCalls, ProgramsCanCleanUpAtTheTimeLimit) {
  folder_.file("slow.sh", R"sh(
clean_up() {
  while grep -q "^PPid:.$PPID\$" /proc/$$/status; do :; done
  yes | head -c 3000000
  echo clean > cleaned
  exit
}
trap clean_up TERM
while :; do tail -f /dev/null & wait; done
)sh");
  EXPECT_TRUE(call("sh slow.sh; true", 0.5).timed_out);
  EXPECT_EQ(text_of(folder_ / "cleaned"), "clean\n");
}

TEST_F(ShellCalls, EndWithTheProcessThatMadeThem) {
  const pid_t maker = fork();
  if (maker == 0) {
    call("echo $$ > shell; tail -f /dev/null & echo $! > program; wait");
    _exit(0);
  }
  EXPECT_TRUE(comes_true([&] { return text_of(folder_ / "program").ends_with('\n'); }));
  kill(maker, SIGKILL);
  waitpid(maker, nullptr, 0);
  EXPECT_TRUE(is_gone("shell"));
  EXPECT_TRUE(is_gone("program"));
}

TEST_F(ShellCalls, LeaveNothingRunning) {
  const CallResult result = call("tail -f /dev/null & echo $! > left");
  EXPECT_TRUE(result.succeeded());
  EXPECT_LT(result.seconds, 60.0) << "what was left held on to the output";
  EXPECT_TRUE(is_gone("left"));
}

TEST_F(ShellCalls, LeaveNoZombiesWhileTheyRun) {
  const CallResult result = call(
      "for i in 1 2 3 4 5; do (sh -c 'exit 0' &); done; sleep 0.3; "
      "cat /proc/[0-9]*/stat 2> /dev/null | grep -c \") Z $PPID \" > zombies; true");
  EXPECT_TRUE(result.succeeded());
  EXPECT_EQ(text_of(folder_ / "zombies"), "0\n");
}

// Out of its group and session, and without a parent.
TEST_F(ShellCalls, LeaveNoDaemonRunning) {
  const std::string daemon =
      "(setsid sh -c 'echo $$ > daemon; exec tail -f /dev/null' > /dev/null 2>&1 &); "
      "until [ -s daemon ]; do :; done; ";
  EXPECT_TRUE(call(daemon + "true").succeeded());
  EXPECT_TRUE(is_gone("daemon"));
  std::filesystem::remove(folder_ / "daemon");
  EXPECT_TRUE(call(daemon + "tail -f /dev/null", 1.0).timed_out);
  EXPECT_TRUE(is_gone("daemon"));
  std::filesystem::remove(folder_ / "daemon");
  const pid_t maker = fork();
  if (maker == 0) {
    call(daemon + "echo > made; tail -f /dev/null");
    _exit(0);
  }
  EXPECT_TRUE(comes_true([&] { return std::filesystem::exists(folder_ / "made"); }));
  kill(maker, SIGKILL);
  waitpid(maker, nullptr, 0);
  EXPECT_TRUE(is_gone("daemon"));
}

TEST_F(ShellCalls, OutputWithoutEndDoesNotHoldUpTheTimeLimit) {
  EXPECT_TRUE(call("yes", 0.2).timed_out);
}

TEST_F(ShellCalls, AFolderThatIsNotThereIsAFailure) {
  const CallResult result = run_shell({"true", folder_ / "none", {}, 60.0});
  EXPECT_EQ(result.exit_status, 126);
  EXPECT_TRUE(has(result.output, "can't be entered"));
}

}  // namespace
}  // namespace npdr
