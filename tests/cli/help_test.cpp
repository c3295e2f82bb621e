// What npdr says of itself, for which no study has to run.
#include "pipeline/plan/plan.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class Help : public CommandTest {};

TEST_F(Help, HelpListAndCompletionKnowAllCommands) {
  const std::string help = npdr({"help"}).out, man = npdr({"man"}).out;
  const std::string offered = npdr({"__complete", ""}).out;
  for (const char* name : {"run", "status", "explain", "validate", "new", "list", "import",
                           "inspect", "verify", "sample", "open", "completion", "log-prob"}) {
    const std::string own = npdr({"help", name}).out;
    EXPECT_EQ(own, npdr({name, "--help"}).out);
    EXPECT_TRUE(has(own, "npdr " + std::string(name))) << "an example\n" << own;
    EXPECT_TRUE(has(own, "Example"));
    EXPECT_TRUE(has(help, "  " + std::string(name) + " "));
    EXPECT_TRUE(has(offered, std::string(name) + "\t"));
    std::string in_roff = name;
    if (in_roff == "log-prob") in_roff = "log\\-prob";
    EXPECT_TRUE(has(man, ".SS npdr " + in_roff + "\n"));
  }
  EXPECT_TRUE(says(npdr({"help", "runn"}).err,
                   {"npdr help: unknown command 'runn' (did you mean 'run'?)"}));
  EXPECT_TRUE(says(npdr({"completion", "tcsh"}).err,
                   {"npdr completion: unknown shell 'tcsh'", "bash, zsh, fish"}));
}

TEST_F(Help, EveryStageHasItsProgram) {
  for (const StageTraits& stage : enum_table(Stage{})) {
    const Outcome help = run(folder_.path(), {std::string(stage.program), "--help"});
    EXPECT_TRUE(has(help.out, std::string(stage.name))) << stage.program << help.err;
  }
}

TEST_F(Help, HelpFitsIntoATerminal) {
  for (const char* name : {"run", "submit", "verify", "list", "export", "help"}) {
    std::istringstream lines(npdr({"help", name}).out);
    std::string line;
    std::getline(lines, line);  // the command in a sentence
    while (std::getline(lines, line)) EXPECT_LE(line.size(), 80) << name << ": " << line;
  }
  EXPECT_TRUE(has(npdr({"help", "run"}).out, "the last stage to run: target, held_out,"));
}

TEST_F(Help, WhatCantBeReadIsNamedAndLeadsToHelp) {
  const auto fails = [&](const std::vector<std::string>& words, const std::string& message) {
    EXPECT_EQ(npdr(2, words).err, message + "\n");
  };
  fails({},
        "npdr: no command; 'npdr new NAME' begins a study, 'npdr run STUDY' brings one up to "
        "date, 'npdr help' lists all commands");
  fails({"run"}, "npdr run: STUDY is required; options and examples: npdr help run");
  EXPECT_TRUE(says(npdr({"run", "study.toml", "--sed", "1"}).err,
                   {"npdr run: unknown option '--sed' (did you mean '--set'?)", "npdr help run"}));
  EXPECT_TRUE(says(npdr({"-v"}).err, {"npdr: unknown option '-v'"}));
}

// What bash would offer for the words of a line.
TEST_F(Help, BashCompletesCommandsOptionsAndValues) {
  npdr(0, {"new", "study"});
  folder_.file("complete.sh", npdr({"completion", "bash"}).out + R"(
offer() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
  _npdr
  echo "${COMPREPLY[*]}"
}
offer npdr stat
offer npdr run --unt
offer npdr run --until pol
offer npdr list me
offer npdr run st
offer npdr run study.toml --only N
offer npdr run nothing.toml --only N
)");
  const std::string command = "cd " + folder_.path().string() +
                              " && PATH=" NPDR_BINARY_DIR
                              "/bin:$PATH bash complete.sh > offered.txt";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(text_of(folder_ / "offered.txt"),
            "status\n--until\npolicy policy_test\nmethods metrics\n\n"
            R"(NPDR\ \(MAF\) NPDR\ \(MoG\))"
            "\n\n");
}

TEST_F(Help, ListSaysWhatThereIsToListAndALineAboutEach) {
  const std::string lists = npdr({"list"}).out;
  for (const char* name :
       {"simulators", "methods", "embeddings", "estimators", "priors", "keys", "layouts"}) {
    EXPECT_TRUE(has(lists, "npdr list " + std::string(name)));
    EXPECT_EQ(npdr({"list", name}).status, 0) << name;
  }
  EXPECT_TRUE(has(npdr({"list", "priors"}).out, "log_uniform        [low, high] with low > 0"));
  const std::string keys = npdr({"list", "keys", "method.training"}).out;
  EXPECT_TRUE(keys.starts_with("method.training.")) << keys;
  EXPECT_FALSE(has(keys, "prior"));
  EXPECT_TRUE(says(npdr({"list", "keys", "method.trainin_"}).err,
                   {"npdr list: unknown beginning of a key 'method.trainin_'",
                    "did you mean 'method.training'?"}));
  EXPECT_TRUE(says(npdr({"list", "methods", "npe"}).err,
                   {"npdr list: 'npe': 'npdr list methods' takes no second word; leave it out"}));
}

TEST_F(Help, NewWritesAStudyThatIsValid) {
  npdr(0, {"new", "mine"});
  npdr(0, {"validate", "mine.toml"});
  npdr(2, {"new", "mine"});
}

}  // namespace
}  // namespace npdr::pipeline
