#include "pipeline/sources/program_call.h"

#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(CommandText, PlaceholdersBecomeQuotedPaths) {
  EXPECT_EQ(filled_command("sim --in={theta} --out={x}", "/t/a.csv", "/t/b c.csv"),
            "sim --in=/t/a.csv --out='/t/b c.csv'");
  EXPECT_EQ(filled_command("sim {x} < {theta}; test -s {x}", "/a", "/b"),
            "sim /b < /a; test -s /b");
}

TEST(CommandText, FilesWithoutAPlaceholderAreAppended) {
  EXPECT_EQ(filled_command("python3 sim.py\n", "/a", "/b"), "python3 sim.py /a /b");
  EXPECT_EQ(filled_command("sim {theta} -o", "/a", "/b"), "sim /a -o /b");
  EXPECT_EQ(filled_command("sim {x}", "/a", "/b"), "sim /b /a");
}

TEST(CommandText, FilesElsewhereAreFoundButForInterpreters) {
  const TempFolder folder;
  for (const char* path : {"study", "env/bin", "sim"}) {
    std::filesystem::create_directories(folder / path);
  }
  folder.file("sim/run.py", "print()");
  folder.file("env/bin/python3", "");
  folder.file("study/own.py", "print()");
  std::filesystem::create_directory_symlink(folder / "study", folder / "link");
  using Words = std::vector<std::string>;
  const std::string absolute = folder / "sim/run.py", linked = folder / "link/own.py";
  EXPECT_EQ(named_paths("../env/bin/python3 ../sim/run.py", folder.path() / "study"),
            Words{"../sim/run.py"});
  EXPECT_EQ(named_paths("/bin/sh " + absolute, folder.path() / "study"), Words{absolute});
  EXPECT_EQ(named_paths("sh " + linked, folder.path() / "study"), Words{linked});
  EXPECT_EQ(named_paths("sh ../sim/run.py > own.py 2>> own.py", folder.path() / "study"),
            Words{"../sim/run.py"})
      << "what is written is no source";
  EXPECT_EQ(named_paths(". /etc/passwd; sh own.py", folder.path() / "study"), Words{"own.py"});
}

TEST(CommandText, ProgramsInABinOfTheFolderAreTheSimulators) {
  const TempFolder folder;
  for (const char* path : {"study/bin", "build"}) {
    std::filesystem::create_directories(folder / path);
  }
  folder.file("build/mysim", "");
  std::filesystem::create_symlink("../../build/mysim", folder / "study/bin/mysim");
  EXPECT_EQ(named_paths("bin/mysim {theta} {x}", folder.path() / "study"),
            std::vector<std::string>{"bin/mysim"});
}

TEST(CommandText, FilesOfTheFolderAreFoundInItsWords) {
  const TempFolder folder;
  folder.file("sim.py", "print()");
  folder.file("my config.json", "{}");
  folder.file("other.txt", "");
  const auto files =
      named_paths("OMP=1 python3 ./sim.py --config='my config.json' /bin/sh ../x nothing {theta}",
                  folder.path());
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0], "./sim.py");
  EXPECT_EQ(files[1], "my config.json");
  EXPECT_EQ(named_paths("sh -c 'python3 sim.py $0 $1' {theta} {x}", folder.path()),
            std::vector<std::string>{"sim.py"});
  EXPECT_EQ(named_paths("python3 my\\ config.json \\", folder.path()),
            std::vector<std::string>{"my config.json"});
  folder.file("config.json", "{}");
  EXPECT_EQ(named_paths("sim 'my config.json'", folder.path()),
            std::vector<std::string>{"my config.json"})
      << "not that of its last word";
  folder.file("a\\b.py", "");
  EXPECT_EQ(named_paths("python3 \"a\\b.py\"", folder.path()), std::vector<std::string>{"a\\b.py"});
  EXPECT_EQ(named_paths(folder / "sim.py", folder.path()).size(), 1u) << "an absolute path into it";
}

}  // namespace
}  // namespace npdr::pipeline
