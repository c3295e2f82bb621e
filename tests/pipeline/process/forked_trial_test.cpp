#include "pipeline/process/forked_trial.h"

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(ForkedTrial, TellsACrashFromAnEnd) {
  EXPECT_EQ(try_in_child([] {}), Ending::came_back);
  EXPECT_EQ(try_in_child([] { throw std::runtime_error("no crash"); }), Ending::came_back);
  EXPECT_EQ(try_in_child([] { std::raise(SIGSEGV); }), Ending::crashed);
  EXPECT_EQ(try_in_child([] { std::abort(); }), Ending::crashed);
  EXPECT_EQ(try_in_child([] { std::_Exit(1); }), Ending::crashed) << "a sanitizer's exit";
}

TEST(ForkedTrial, EndsWhatNeverDoesAndLeavesThisProcessAsItWas) {
  EXPECT_EQ(try_in_child([] { pause(); }, {.seconds = 1}), Ending::ran_out_of_time);
  EXPECT_EQ(try_in_child([] { std::raise(SIGXCPU); }), Ending::ran_out_of_time);
  EXPECT_EQ(try_in_child([] { std::raise(SIGKILL); }), Ending::came_back) << "from outside";
  int value = 1;
  EXPECT_EQ(try_in_child([&] { value = 2; }), Ending::came_back);
  EXPECT_EQ(value, 1);
}

TEST(ForkedTrial, TellsADamagedFileFromASlowOne) {
  const auto read_by = [](int signal) {
    return [signal] { try_to_read("recording.h5", [signal] { std::raise(signal); }); };
  };
  EXPECT_TRUE(says(message_of<InputError>(read_by(SIGSEGV)),
                   {"recording.h5: is damaged: the HDF5 library crashes on it; copy it again"}));
  EXPECT_TRUE(says(message_of<InputError>(read_by(SIGXCPU)),
                   {"recording.h5: reading it came to no end within 60 s of processor time",
                    "or its disk is too slow"}));
  EXPECT_NO_THROW(read_by(SIGKILL)());
}

TEST(ForkedTrial, LargeFilesAndTheirShardsHaveMoreTime) {
  const TempFolder folder;
  const std::filesystem::path file = folder.file("simulate.h5", "");
  const auto said = [&] {
    return message_of<InputError>([&] { try_to_read(file, [] { std::raise(SIGXCPU); }); });
  };
  std::filesystem::resize_file(file, 4'000'000'000);  // without a block on the disk
  EXPECT_TRUE(has(said(), "within 260 s of processor time, 800 s in all"));
  std::filesystem::create_directory(folder / "simulate");
  std::filesystem::resize_file(folder.file("simulate/0-100.h5", ""), 2'000'000'000);
  EXPECT_TRUE(has(said(), "within 360 s of processor time, 900 s in all"));
}

}  // namespace
}  // namespace npdr::pipeline
