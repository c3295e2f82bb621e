/// `npdr import` as a program; what it says of recordings is tests/golden/import.txt.
#include "pipeline/artefacts/recording.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

class ImportCommand : public CommandTest {
 protected:
  ImportCommand() {
    folder_.file("a.csv",
                 "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n0.0,0.1,1,5\n0.1,0.2,2,6\n");
  }
  Outcome import(const std::string& output, const std::vector<std::string>& more = {}) const {
    return npdr(joined({"import", "a.csv", "--simulator", "pendulum", "-o", output}, more));
  }
};

TEST_F(ImportCommand, WritesARecordingAndSaysWhatIsNext) {
  const Outcome outcome = import("r.h5");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(outcome.out.ends_with(
      "next: npdr run STUDY.toml --set target.recording=r.h5; npdr new NAME writes a study to "
      "start from\n"))
      << outcome.out;
  EXPECT_EQ(read_recording(folder_ / "r.h5").rollouts[0].states, (RowMatrix{{0.1, 1}, {0.2, 2}}));
  EXPECT_EQ(import("new.h5", {"--dt", "0"}).status, 2);
  EXPECT_EQ(import("r.h5").status, 2) << "it is there already";
  EXPECT_EQ(import("r.h5", {"--force"}).status, 0);
}

TEST_F(ImportCommand, LinksStayLinks) {
  std::filesystem::create_directory(folder_ / "big");
  std::filesystem::create_symlink("big/real.h5", folder_ / "r.h5");
  EXPECT_EQ(import("r.h5").status, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "r.h5"));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / "big/real.h5"));
  EXPECT_TRUE(says(import("r.h5").err, {"npdr import: big/real.h5: is there already"}));
}

}  // namespace
}  // namespace npdr::pipeline
