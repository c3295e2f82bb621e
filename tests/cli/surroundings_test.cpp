// Signals, limits, streams and leftovers that a program finds where it runs.
#include <sys/stat.h>

#include "core/atomic_file.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

class Surroundings : public SmallStudyTest {
 protected:
  // By a shell, which sets limits and closes streams first.
  Outcome in_shell(const std::string& before, const std::string& after = "") const {
    const std::string npdr = fs::path(NPDR_BINARY_DIR) / "bin/npdr";
    return run(folder_.path(),
               {"/bin/sh", "-c",
                before + "; exec " + npdr +
                    " run small.toml --only 'NPDR (MAF)' --until simulate " + after});
  }

  fs::path logs() const { return folder_ / "runs/small/logs"; }

  // A signal ends the program soon with this status, and what it has started, whose number stands
  // in the file "pid".
  void expect_end(const std::vector<std::string>& words, int signal, int status,
                  bool is_for_all = false) const {
    fs::remove(folder_ / "pid");
    const Program program(folder_.path(), words);
    ASSERT_TRUE(comes_true([&] { return text_of(folder_ / "pid").ends_with('\n'); }));
    is_for_all ? program.send_to_group(signal) : program.send(signal);
    EXPECT_TRUE(program.ends_within(10.0));
    program.send(SIGKILL);
    EXPECT_EQ(program.wait().status, status);
    const pid_t started = std::stoi(text_of(folder_ / "pid"));
    EXPECT_TRUE(comes_true([&] { return has_ended(started); }));
  }
};

TEST_F(Surroundings, CommandsThatSaveNothingEndAtOnce) {
  npdr(0, {"run", "small.toml", "--only", "NPDR (MAF)", "--until", "infer"});
  for (const int signal : {SIGINT, SIGTERM}) {
    const Program endless(
        folder_.path(),
        {"npdr", "sample", "runs/small/npdr-maf/seed-1/round-1/infer.h5", "-n", "30000000"},
        {.out = "/dev/null"});
    EXPECT_FALSE(endless.ends_within(1.0));
    endless.send(signal);
    EXPECT_TRUE(endless.ends_within(5.0));
    endless.send(SIGKILL);
    EXPECT_EQ(endless.wait().status, 128 + signal);
  }
}

TEST_F(Surroundings, ResultsBesideTheStudyAreNamedFromElsewhere) {
  npdr(0, {"run", "small.toml", "--only", "NPDR (MAF)", "--until", "propose"});
  fs::create_directory(folder_ / "elsewhere");
  const auto warning = [&](const std::vector<std::string>& words) {
    return run(folder_ / "elsewhere", words).err;
  };
  for (const std::string command : {"status", "explain", "open", "run"}) {
    std::vector<std::string> words = {"npdr", command, "../small.toml"};
    if (command == "run") words.insert(words.end(), {"--until", "target"});
    EXPECT_TRUE(warning(words).starts_with(
        "npdr " + command +
        ": warning: no results of this study in runs, but in ../runs; to use those: --work "
        "../runs\n"))
        << command;
  }
  EXPECT_EQ(warning({"npdr", "open", "../small.toml"}), "") << "it has its own by now";
  EXPECT_EQ(warning({"npdr", "open", "../small.toml", "--work", "../runs"}), "");
}

// In place of gnuplot's, a program that never ends. Ctrl-C reaches all of a terminal's processes,
// `kill` the run alone.
TEST_F(Surroundings, AGnuplotThatHangsDoesNotKeepARunFromStopping) {
  fs::create_directory(folder_ / "bin");
  folder_.file("bin/gnuplot",
               "#!/bin/sh\necho $$ > " + (folder_ / "pid").string() + "\nexec sleep 1000\n");
  fs::permissions(folder_ / "bin/gnuplot", fs::perms::owner_all);
  const ProgramsOnPath hanging(folder_ / "bin");
  expect_end({"npdr", "run", "small.toml"}, SIGINT, 75, true);
  expect_end({"npdr", "run", "small.toml"}, SIGTERM, 75);
}

TEST_F(Surroundings, ASecondRequestEndsARunThatCannotStop) {
  const Program program(folder_.path(),
                        {"npdr", "run", "small.toml", "--set", "method.training.max_epochs=1000000",
                         "--set", "method.training.stop_after_epochs=1000000"});
  ASSERT_TRUE(begins_to_make(program, folder_ / "runs/.cache/infer"));
  const std::vector<pid_t> children = program.children();
  for (const pid_t child : children) kill(child, SIGSTOP);
  // One that follows within a second counts as the same.
  EXPECT_TRUE(comes_true([&] {
    program.send(SIGTERM);
    return program.has_ended();
  }));
  EXPECT_EQ(program.wait().status, 128 + SIGTERM);
  for (const pid_t child : children) kill(child, SIGCONT);
  for (const pid_t child : children) EXPECT_TRUE(comes_true([&] { return has_ended(child); }));
}

TEST_F(Surroundings, ACommandThatWaitsForAFileEndsAtOnce) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    const Program waiting(folder_.path(), {"npdr", "validate", "pipe"});
    // It opens without waiting once somebody reads.
    int end = -1;
    ASSERT_TRUE(comes_true([&] { return (end = open(pipe.c_str(), O_WRONLY | O_NONBLOCK)) >= 0; }));
    waiting.send(signal);
    EXPECT_EQ(waiting.wait().status, 128 + signal);
    close(end);
  }
  for (const std::string command : {"import", "inspect", "verify", "sample"}) {
    std::vector<std::string> words = {command, "pipe"};
    if (command == "import") {
      words = joined(words, {"--states", "a [m]", "--actions", "b [m]", "--dt", "0.1", "-o", "o"});
    }
    EXPECT_TRUE(has(npdr(2, words).err, "pipe: isn't a"));
  }
}

TEST_F(Surroundings, AVerificationEndsAtOnceWithTheProgramThatItRuns) {
  folder_.file("c.toml", command_study("c").method("A", {"num_simulations = 100"}));
  folder_.file("x_o.csv", "0.5\n");
  folder_.file("simulate.sh",
               "if [ -e hangs ]; then echo $$ > pid; exec sleep 1000; fi\n"
               "awk -F, 'NR > 1 { print $1 }' $1 > $2\n");
  npdr(0, {"run", "c.toml", "--until", "simulate"});
  folder_.file("hangs", "");
  for (const int signal : {SIGINT, SIGTERM}) {
    expect_end({"npdr", "verify", "runs/c/a/seed-1/round-1/simulate.h5", "--run-command"}, signal,
               128 + signal);
  }
}

TEST_F(Surroundings, ClosedStreamsTakeNoFileOfOurs) {
  for (const std::string closed : {"<&-", "<&- 2>&-"}) {
    fs::remove_all(folder_ / "runs");
    EXPECT_EQ(in_shell("ulimit -f 8", closed).status, 1);
    std::string said;
    for (const auto& log : fs::directory_iterator(logs())) said += text_of(log.path());
    EXPECT_TRUE(has(said, "File too large")) << closed;
  }
}

TEST_F(Surroundings, TheMaskSaysWhoMayWriteLogs) {
  EXPECT_EQ(in_shell("umask 002").status, 0);
  struct stat status = {};
  ASSERT_EQ(stat((logs() / "target.log").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0664u);
}

TEST_F(Surroundings, ALogIsNoLink) {
  fs::create_directories(logs());
  folder_.file("victim", "theirs\n");
  fs::create_symlink(folder_ / "victim", logs() / "target.log");
  const Outcome outcome = in_shell("true");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(has(outcome.err, "target.log: can't be written"));
  EXPECT_EQ(text_of(folder_ / "victim"), "theirs\n");
}

TEST_F(Surroundings, WhatDeadProgramsLeftBehindGoesAlsoWhereNothingIsMissing) {
  ASSERT_EQ(in_shell("true").status, 0);
  const Program dead(folder_.path(), {"npdr", "--version"});
  dead.wait();
  const std::string name = "." + process_space() + "." + std::to_string(dead.pid()) + ".0.tmp";
  fs::create_directories(folder_ / "runs/small/tables");
  for (const std::string place : {"runs/.cache/target/.a", "runs/small/tables/.a"}) {
    folder_.file(place + name, "");
  }
  EXPECT_EQ(in_shell("true").status, 0);
  EXPECT_EQ(temporaries(folder_ / "runs"), std::set<std::string>());
}

}  // namespace
}  // namespace npdr::pipeline
