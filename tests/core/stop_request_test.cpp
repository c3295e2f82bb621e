#include "core/stop_request.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

#include "tests/temp_folder.h"
#include "tests/wait_for.h"

namespace npdr {
namespace {

// A process that hears requests to stop, and never looks at them.
class DeafProcess {
 public:
  explicit DeafProcess(const std::filesystem::path& ready) : pid_(fork()) {
    if (pid_ != 0) {
      EXPECT_TRUE(comes_true([&] { return std::filesystem::exists(ready); }));
      return;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    watch_for_stop_requests();
    std::ofstream(ready) << "";
    for (;;) pause();
  }
  ~DeafProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  DeafProcess(const DeafProcess&) = delete;
  DeafProcess& operator=(const DeafProcess&) = delete;

  void send(int signal) const { kill(pid_, signal); }
  bool ends_within(double seconds) const {
    return comes_true([&] { return has_ended(pid_); }, std::chrono::duration<double>(seconds));
  }

 private:
  pid_t pid_;
};

TEST(StopRequest, ASecondOneALittleLaterEndsTheProcess) {
  const TempFolder folder;
  const DeafProcess process(folder / "ready");
  for (int i = 0; i < 3; ++i) process.send(SIGTERM);  // as a batch system and a parent may
  EXPECT_FALSE(process.ends_within(1.1));
  process.send(SIGINT);
  EXPECT_TRUE(process.ends_within(10.0));
}

TEST(StopRequest, WarningsOfABatchSystemAreNoSecondRequest) {
  const TempFolder folder;
  const DeafProcess process(folder / "ready");
  process.send(SIGUSR1);
  EXPECT_FALSE(process.ends_within(1.1));
  process.send(SIGTERM);
  EXPECT_FALSE(process.ends_within(0.3));
}

}  // namespace
}  // namespace npdr
