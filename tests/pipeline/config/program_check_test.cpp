#include "pipeline/config/program_check.h"

#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

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
