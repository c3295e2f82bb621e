// Texts that are no study, or none that anybody means; programs that a study names.

#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/study_check.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class StudySyntax : public FolderTest {};

// A key in as many tables.
std::string dotted(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "a.";
  return text;
}

TEST_F(StudySyntax, OfManyTheFirstAreTold) {
  std::string unknown = "[evaluate]\n";
  for (int i = 0; i < 100'000; ++i) unknown += "k" + std::to_string(i) + " = 1\n";
  const std::string problems = problems_after("[prior]", unknown + "[prior]");
  EXPECT_EQ(std::ranges::count(problems, '\n'), 50);
  EXPECT_TRUE(problems.starts_with("s.toml:12:1: evaluate: unknown key 'k0'"));
  EXPECT_TRUE(problems.ends_with("\nand 99950 more problems"));
}

// Many texts in a row that differ by a number.
std::string numbered(int count, const std::string& before, const std::string& after) {
  std::string result;
  for (int i = 0; i < count; ++i) result += before + std::to_string(i) + after;
  return result;
}

TEST_F(StudySyntax, NobodyMeansMoreThanAThousandOfAKind) {
  EXPECT_TRUE(
      problems_after("[prior]", "[prior]\n" + numbered(1000, "a", " = { uniform = [0, 1] }\n"))
          .ends_with("must be of 1 to 1000 parameters"));
  EXPECT_TRUE(problems_after("pole_mass = 1.1", numbered(1000, "a", " = 1, ") + "pole_mass = 1.1")
                  .ends_with("must be of at most 1000 numbers"));
  EXPECT_EQ(problems_of(kStudyText + numbered(999, "[[method]]\nfoo = ", "\n")),
            "s.toml:15:1: method is there 1001 times, must be at most 1000");
}

TEST_F(StudySyntax, ALibrarysSettingsAreReadAtOnceHoweverMany) {
  const std::string library =
      "library = \"no.so\"\nsettings = { " + numbered(200'000, "k", " = 1, ");
  EXPECT_NE(problems_after("name = \"pendulum\"", library + "end = 1 }"), "");
}

TEST_F(StudySyntax, HostileFilesAreRefused) {
  std::filesystem::create_directory(folder_ / "folder.toml");
  const std::vector<std::pair<std::filesystem::path, std::string>> cases = {
      {folder_ / "missing.toml", "missing.toml: can't be opened"},
      {folder_ / "folder.toml", "folder.toml: is a folder, must be a study file"},
      {folder_.file("big.toml", std::string(10'000'001, '#')),
       "big.toml: is larger than 10 MB: not a study file"},
      {"/dev/zero", "/dev/zero: is larger than 10 MB: not a study file"},
      {folder_.file("binary.toml", std::string("\x7f"
                                               "ELF\x02\x01\0\0",
                                               8)),
       "binary.toml:1:1: "},
      {folder_.file("deep.toml", dotted(200'000) + "a = 1"), "deep.toml: holds 200000 dots"},
      {folder_.file("nested.toml", "a = " + std::string(100'000, '[')), "nested.toml:1"}};
  for (const auto& [path, said] : cases) {
    const std::string message = problem([&, path = path] { read_study(path); });
    EXPECT_TRUE(message.starts_with(said)) << message;
  }
}

TEST_F(StudySyntax, ANameOfNoStudyIsGuessedAt) {
  folder_.file("mine.toml", "");
  const std::string guess = "did you mean mine.toml?";
  for (const char* name : {"mine", "mien.toml"}) {
    EXPECT_TRUE(has(problem([&] { read_study(folder_ / name); }), guess)) << name;
  }
  std::filesystem::create_directory(folder_ / "mine");
  EXPECT_TRUE(has(problem([&] { read_study(folder_ / "mine"); }), "is a folder, " + guess));
  EXPECT_FALSE(has(problem([&] { read_study(folder_ / "another"); }), "did you mean"));
}

TEST_F(StudySyntax, ManyDotsThatAreAllowedDontOverflowTheStack) {
  EXPECT_TRUE(has(problems_of(dotted(4'999) + "a = 1"), "unknown key 'a'"));
  std::string digits;  // as many dots as may look like a number's
  for (int i = 0; i < 4'998; ++i) digits += "1.1 . ";
  EXPECT_TRUE(has(problems_of(digits + "a = 1"), "unknown key '1'"));
  EXPECT_TRUE(has(problems_of(digits + ". . a = 1"), "holds 5000 dots"));
  std::string numbers;
  for (int i = 0; i < 20'000; ++i) numbers += "[0.25, -1.5e3],";
  EXPECT_TRUE(has(problems_of("a = [" + numbers + "]"), "unknown key 'a'"));
  EXPECT_TRUE(has(problems_of(kStudyText, {dotted(1000) + "a=1"}), "unknown key 'a'"));
  EXPECT_TRUE(has(problems_of(kStudyText, {dotted(1001) + "a=1"}), "holds 1001 dots"));
}

class ProgramCheck : public FolderTest {
 protected:
  std::string fault(const std::string& command) const {
    return program_fault(command, folder_.path());
  }
};

TEST_F(ProgramCheck, NamesTheFileThatIsntThere) {
  const std::string where = " in the folder '" + folder_.path().string() + "'";
  EXPECT_EQ(fault("python3 sim.py"), "there is no 'sim.py'" + where);
  EXPECT_EQ(fault("/usr/bin/python3.11 sim.py {theta} {x}"), "there is no 'sim.py'" + where);
  EXPECT_EQ(fault("sh lab/sim.sh > log"), "there is no 'lab/sim.sh'" + where);
  EXPECT_EQ(fault("./sim --fast"), "there is no './sim'" + where);
  folder_.file("sim", "#!/bin/sh\n");
  EXPECT_EQ(fault("./sim --fast"), "'./sim' may not be executed (chmod +x)");
  folder_.file("sim.py", "");
  EXPECT_EQ(fault("python3 sim.py"), "");
}

TEST_F(ProgramCheck, LeavesToTheShellWhatOnlyAShellKnows) {
  for (const char* command :
       {"cd lab && python3 sim.py", "python3 -m lab.sim", "python3 \"$HOME/sim.py\"", "'./my sim'",
        "WHAT=1 ./sim", "test -e sim.py || touch sim.py; python3 sim.py", "sh -c 'sim'", "sim",
        "bash +e sim.sh", ""}) {
    EXPECT_EQ(fault(command), "") << command;
  }
}

TEST_F(ProgramCheck, AsksAShellForProgramsWithoutAFolder) {
  for (const char* command : {"sh sim.sh", "cd lab && ./sim", "exec ./sim", "./sim", "$SIM", ""}) {
    EXPECT_EQ(unknown_program(command), "") << command;
  }
  EXPECT_EQ(unknown_program("pythn3 sim.py"), "pythn3");
}

}  // namespace
}  // namespace npdr::pipeline
