#include <fmt/format.h>

#include "tests/faults/fault_study.h"
#include "tests/faults/tiny_disk.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

class FullDisk : public Faults {
 protected:
  // The work folder, moved to a disk of its own.
  void SetUp() override {
    fs::rename(folder_->work(), folder_->path() / "finished");
    disk_ = std::make_unique<TinyDisk>(folder_->work(), "size=8m");
    if (!disk_->is_there()) GTEST_SKIP() << disk_->why_not();
    fs::copy(folder_->path() / "finished", folder_->work(),
             fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  }
  void TearDown() override {
    disk_.reset();
    fs::remove_all(folder_->work());
    fs::rename(folder_->path() / "finished", folder_->work());
  }

  static void expect_clear(const Outcome& outcome, const Artefact& artefact) {
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_TRUE(has(outcome.err, {"No space left on device", "free some space"}));
    const std::string place = artefact.stage == "report"     ? "runs/faults/"
                              : artefact.stage == "simulate" ? artefact.key
                                                             : artefact.path.filename().string();
    EXPECT_TRUE(has(outcome.err, place));
    EXPECT_FALSE(fs::exists(artefact.path)) << artefact.label;
    EXPECT_EQ(temporaries(folder_->work()), std::set<std::string>()) << artefact.label;
  }

  std::unique_ptr<TinyDisk> disk_;
};

// With more and more space, until it is enough.
TEST_F(FullDisk, EveryStageSaysSoAndGoesOnOnceThereIsSpace) {
  for (const std::string stage :
       {"propose", "simulate", "infer", "evaluate", "baseline", "diagnose", "report"}) {
    const Artefact artefact = folder_->artefacts_of(stage).front();
    fs::remove_all(artefact.path);
    if (stage == "simulate") fs::remove_all(artefact.stem());
    if (stage == "report") {
      fs::remove_all(folder_->readable() / "tables");
      fs::remove_all(folder_->readable() / "figures");
    }
    int num_failed = 0;
    for (std::uintmax_t space = 0;; space = space == 0 ? 4096 : 3 * space) {
      disk_->leave(space);
      const Outcome made = make(artefact);
      if (made.status == 0) break;
      expect_clear(made, artefact);
      if (++num_failed > 9) break;
    }
    disk_->free_all();
    fmt::print("{}: {} amounts of space were too small\n", artefact.label, num_failed);
    EXPECT_GE(num_failed, 2) << stage;
    EXPECT_LE(num_failed, 9) << stage;
  }
  expect_to_go_on();
}

TEST_F(FullDisk, ARunSaysSoAndGoesOnOnceThereIsSpace) {
  fs::remove_all(folder_->cache());
  fs::create_directories(folder_->cache());
  disk_->leave(150 << 10);
  EXPECT_TRUE(has(folder_->npdr(1, {"run"}).err, {"No space left on device", "free some space"}));
  disk_->free_all();
  expect_to_go_on();
}

}  // namespace
}  // namespace npdr::pipeline
