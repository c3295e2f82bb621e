#include "pipeline/config/program_check.h"

#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class ProgramCheck : public ::testing::Test {
 protected:
  std::string fault(const std::string& command) const {
    return program_fault(command, folder_.path());
  }

  TempFolder folder_;
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

TEST_F(ProgramCheck, AStudySaysWhereTheCommandStands) {
  const std::string text =
      "[study]\nname = 'a'\n[target]\nobservation = '" +
      folder_.file("x_o.csv", "a\n1\n").string() + "'\n[simulator]\nfolder = '" +
      folder_.path().string() +
      "'\ncommand = 'python3 sim.py'\n[prior]\na = { normal = [0.0, 1.0] }\n[[method]]\n"
      "name = 'NPE'\nnum_simulations = 100\n";
  const std::string message = message_of<InputError>([&] { parse_study(text, "s.toml"); });
  EXPECT_TRUE(
      message.starts_with("s.toml:7:11: simulator.command = 'python3 sim.py', must be a "
                          "command that can be run: there is no 'sim.py' in the folder"))
      << message;
}

}  // namespace
}  // namespace npdr::pipeline
