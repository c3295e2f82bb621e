#include "sim/library/library_simulator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "tests/message_of.h"
#include "tests/sim/library/compiled_library.h"
#include "tests/temp_folder.h"

namespace npdr::sim {
namespace {

Target rollouts(Index count, Index steps) {
  Target target;
  target.dt = 0.02;
  target.state_channels = {{"q", "m"}, {"v", "m/s"}};
  target.action_channels = {{"force", "N"}};
  for (Index h = 0; h < count; ++h) {
    Rollout rollout{std::to_string(h), RowMatrix::Zero(steps + 1, 2), RowMatrix::Zero(steps, 1)};
    for (Index t = 0; t <= steps; ++t) {
      rollout.states.row(t) << 0.5 - 0.1 * static_cast<double>(h), 0.01 * static_cast<double>(t);
    }
    for (Index t = 0; t < steps; ++t)
      rollout.actions(t, 0) = std::sin(0.3 * static_cast<double>(t));
    target.rollouts.push_back(rollout);
  }
  return target;
}

// With the seeds 0, 1, 2 and so on.
Trajectories replay(const LibrarySimulator& simulator, const Segments& segments,
                    const RowMatrix& theta, Index store_every = 1) {
  std::vector<std::uint32_t> seeds(static_cast<std::size_t>(theta.rows()));
  std::iota(seeds.begin(), seeds.end(), 0u);
  return simulator.replay(segments, store_every, theta, seeds);
}

class Libraries : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    compile_library(spring_source(), *folder_ / "spring.so");
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::filesystem::path spring() { return *folder_ / "spring.so"; }

  // The example simulated here: mass, stiffness, damping, friction.
  static RowMatrix by_hand(const Segments& segments, const Eigen::RowVectorXd& theta) {
    RowMatrix states(segments.num_steps(), 2);
    Index row = 0;
    for (Index s = 0; s < segments.num_segments(); ++s) {
      double q = segments.first_states(s, 0), v = segments.first_states(s, 1);
      for (Index t = 0; t < segments.steps[static_cast<std::size_t>(s)]; ++t, ++row) {
        for (int k = 0; k < 10; ++k) {
          const double pull = segments.actions(row, 0) - theta(1) * q - theta(2) * v;
          v += segments.dt / 10.0 / theta(0) * (pull - theta(3) * std::tanh(100.0 * v));
          q += segments.dt / 10.0 * v;
        }
        states.row(row) << q, v;
      }
    }
    return states;
  }

  inline static TempFolder* folder_ = nullptr;
};

TEST_F(Libraries, DontEndTheProgram) {
  const auto source = folder_->file("exits.c", R"c(#include <stdlib.h>
#include "npdr_simulator.h"
const npdr_library* npdr_simulator(void) { exit(0); })c");
  const auto library = compile_library(source, *folder_ / "exits.so");
  EXPECT_EXIT(LibrarySimulator({library}), ::testing::ExitedWithCode(1),
              "exits.so: calls exit\\(\\), which ends the program");
}

TEST_F(Libraries, DescribeThemselves) {
  const LibrarySimulator simulator({spring()});
  const SimulatorInfo& info = simulator.info();
  EXPECT_EQ(info.name, "spring");
  ASSERT_EQ(info.parameters.size(), 4u);
  EXPECT_EQ(info.parameters[1].name, "stiffness");
  EXPECT_EQ(info.parameters[1].unit, "N/m");
  EXPECT_EQ(info.parameters[1].nominal, 20.0);
  EXPECT_EQ(info.state_channels, (std::vector<Channel>{{"q", "m"}, {"v", "m/s"}}));
  EXPECT_EQ(info.action_channels, (std::vector<Channel>{{"force", "N"}}));
}

TEST_F(Libraries, ReplaySegmentsFromTheirRecordedStates) {
  const LibrarySimulator simulator({spring()});
  const Segments segments = cut(rollouts(2, 25), 10);
  EXPECT_EQ(segments.steps, (std::vector<std::int64_t>{10, 10, 5, 10, 10, 5}));
  EXPECT_EQ(segments.past, (std::vector<std::int64_t>{0, 10, 20, 0, 10, 20}));
  RowMatrix theta(2, 4);
  theta << 1.0, 20.0, 0.3, 0.2, 2.0, 5.0, 0.1, 0.0;
  const Trajectories x = replay(simulator, segments, theta, 5);
  ASSERT_EQ(x.num_steps, 5);
  for (Index i = 0; i < 2; ++i) {
    const RowMatrix expected = by_hand(segments, theta.row(i));
    for (Index h = 0; h < 2; ++h) {
      for (Index t = 0; t < 5; ++t) {
        // The compiler may contract what this one doesn't.
        EXPECT_NEAR(x.rollout(i, h)(t, 0), expected(h * 25 + 5 * t + 4, 0), 1e-6);
        EXPECT_NEAR(x.rollout(i, h)(t, 1), expected(h * 25 + 5 * t + 4, 1), 1e-6);
      }
    }
  }
}

TEST_F(Libraries, GiveTheSameBitsHoweverRowsAreBatched) {
  const LibrarySimulator simulator({spring()});
  const Segments segments = cut(rollouts(2, 40), 0);
  RowMatrix theta(100, 4);
  for (Index i = 0; i < 100; ++i) theta.row(i) << 1.0, 10.0 + static_cast<double>(i), 0.3, 0.2;
  const Trajectories all = replay(simulator, segments, theta);
  for (const Index i : {0, 31, 32, 99}) {
    const std::vector<std::uint32_t> seed = {static_cast<std::uint32_t>(i)};
    const Trajectories one = simulator.replay(segments, 1, theta.row(i), seed);
    EXPECT_TRUE(std::ranges::equal(one.row(0), all.row(i))) << i;
  }
}

TEST_F(Libraries, RowsOutsideOfLimitsAreNotSimulated) {
  const LibrarySimulator simulator({spring()});
  RowMatrix theta(3, 4);
  theta << 1.0, 20.0, 0.3, 0.2, -1.0, 20.0, 0.3, 0.2, 1.0, 1e300, 0.3, 0.2;
  const Trajectories x = replay(simulator, cut(rollouts(1, 50), 0), theta);
  EXPECT_EQ(x.status, (std::vector<RolloutStatus>{RolloutStatus::ok, RolloutStatus::out_of_limits,
                                                  RolloutStatus::diverged}));
  EXPECT_TRUE(std::isnan(x.row(1)[0]) && std::isnan(x.row(2).back()));
}

TEST_F(Libraries, TargetsWithOtherChannelsAreAnError) {
  const LibrarySimulator simulator({spring()});
  Target target = rollouts(1, 5);
  target.action_channels.clear();
  target.rollouts[0].actions.resize(5, 0);
  EXPECT_THROW(replay(simulator, cut(target, 0), RowMatrix::Ones(1, 4)), InputError);
  EXPECT_THROW(replay(simulator, cut(rollouts(1, 5), 0), RowMatrix::Ones(1, 3)), ShapeError);
}

// A library that does what `settings` say. The first letters of its settings are what it is asked
// to do wrong.
constexpr const char* kHostile = R"cpp(
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <unistd.h>
#include "npdr_simulator.h"

  struct npdr_instance {
    char what[64];
  };

  namespace {
  bool is(npdr_instance* i, const char* what) { return std::strstr(i->what, what) != nullptr; }

  int open_it(const char* settings, const char*, npdr_instance** instance, char* error) {
    if (std::strstr(settings, "open-fails")) {
      std::strcpy(error, "no such robot");
      return 1;
    }
    if (std::strstr(settings, "open-fails-silently")) return 1;
    if (std::strstr(settings, "open-throws")) throw std::runtime_error("thrown out");
    if (std::strstr(settings, "open-throws-int")) throw 7;
    while (std::strstr(settings, "open-loops")) usleep(1000);
    if (std::strstr(settings, "open-gives-nothing")) return 0;
    *instance = new npdr_instance;
    std::snprintf((*instance)->what, sizeof((*instance)->what), "%s", settings);
    return 0;
  }

  int describe(npdr_instance* i, npdr_description* d, char* error) {
    static npdr_parameter p[2];
    static const npdr_channel q[] = {{"q", "m"}, {"v", "m/s"}}, f[] = {{"force", "N"}};
    static char unbounded[5000];
    std::memset(unbounded, 'x', sizeof(unbounded));
    p[0] = {"a", "kg", 1.0, 0.0, 2.0, 0.0, nullptr};
    p[1] = {"b", nullptr, 1.0, -INFINITY, INFINITY, 0.0, ""};
    *d = {nullptr, nullptr, 2, p, 2, q, 1, f, nullptr};
    if (is(i, "no-states")) d->num_states = 0;
    if (is(i, "negative")) d->num_parameters = -3;
    if (is(i, "null-list")) d->states = nullptr;
    if (is(i, "null-name")) p[1].name = nullptr;
    if (is(i, "long-name")) p[1].name = unbounded;
    if (is(i, "control")) p[1].name = "a\nb";
    if (is(i, "twice")) p[1].name = "a";
    if (is(i, "nominal")) p[0].nominal = 5.0;
    if (is(i, "nan")) p[0].nominal = NAN;
    if (is(i, "period")) p[0].period = -1.0;
    if (is(i, "long-error")) {
      std::memset(error, 'e', NPDR_ERROR_SIZE);
      return 2;
    }
    return 0;
  }

  int replay(npdr_instance* i, const npdr_batch* b, double* states, uint8_t* status, char* error) {
    if (is(i, "replay-fails")) {
      std::strcpy(error, "motor on fire");
      return 1;
    }
    while (is(i, "replay-loops") && b->theta[1] > 0.5) usleep(1000);
    if (is(i, "slow")) usleep(50'000);
    if (is(i, "replay-throws")) throw std::logic_error("off by one");
    if (is(i, "status")) status[0] = 77;
    for (int64_t k = 0; k < b->num_rows * b->num_steps * 2; ++k)
      states[k] = is(i, "infinite") ? INFINITY : b->seeds[0];
    return 0;
  }

  void close_it(npdr_instance* i) {
    while (is(i, "close-loops")) usleep(1000);
    delete i;
  }
  }  // namespace

#ifndef WITHOUT
  const npdr_library* npdr_simulator(void) {
    static const npdr_library all = {VERSION, open_it, describe, REPLAY, close_it};
    return RETURNED;
  }
#endif
)cpp";

class HostileLibraries : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    const auto source = folder_->file("hostile.cpp", kHostile);
    compile_library(source, *folder_ / "hostile.so",
                    "-DVERSION=1 -DREPLAY=replay '-DRETURNED=&all'");
  }
  static void TearDownTestSuite() { delete folder_; }

  // Message about the library, which begins with its file.
  static std::string bare(const std::string& message) {
    const std::size_t end = message.find(".so: ");
    EXPECT_NE(end, std::string::npos) << message;
    return message.substr(std::min(end + 5, message.size()));
  }
  static std::string message(const std::string& what) {
    return bare(message_of<InputError>([&] {
      LibrarySimulator({*folder_ / "hostile.so", "{\"" + what + "\"}"});
    }));
  }
  // Each has a name of its own: a library that is loaded stays so.
  static std::string message_of_other(const std::string& options) {
    static int number = 0;
    const auto library = compile_library(*folder_ / "hostile.cpp",
                                         *folder_ / fmt::format("other{}.so", number++), options);
    return bare(message_of<InputError>([&] { LibrarySimulator({library}); }));
  }

  inline static TempFolder* folder_ = nullptr;
};

TEST_F(HostileLibraries, FilesThatAreNoLibraryAreAnError) {
  EXPECT_TRUE(says(message_of<InputError>([] { LibrarySimulator({"/nowhere/mine.so"}); }),
                   {"/nowhere/mine.so", "isn't there", "cc -shared"}));
  const auto text = folder_->file("text.so", "not a library");
  EXPECT_TRUE(
      says(bare(message_of<InputError>([&] { LibrarySimulator({text}); })), {"can't be loaded"}));
  const auto cut = *folder_ / "cut.so";
  std::filesystem::copy_file(*folder_ / "hostile.so", cut);
  std::filesystem::resize_file(cut, 5000);
  EXPECT_TRUE(says(bare(message_of<InputError>([&] { LibrarySimulator({cut}); })),
                   {"has 5000 bytes of", "it was cut; compile or copy it again"}));
  EXPECT_TRUE(says(message_of<InputError>([] { LibrarySimulator({"/dev/zero"}); }),
                   {"/dev/zero", "isn't there"}));
}

TEST_F(HostileLibraries, LibrariesWithoutTheInterfaceAreAnError) {
  EXPECT_TRUE(says(message_of_other("-DWITHOUT -DVERSION=1 -DREPLAY=replay"),
                   {"exports no function npdr_simulator()"}));
  EXPECT_TRUE(says(message_of_other("-DVERSION=9 -DREPLAY=replay '-DRETURNED=&all'"),
                   {"has version 9", "must be 1"}));
  EXPECT_TRUE(says(message_of_other("-DVERSION=1 -DREPLAY=nullptr '-DRETURNED=&all'"),
                   {"npdr_simulator() leaves out one of"}));
  EXPECT_TRUE(says(message_of_other("-DVERSION=1 -DREPLAY=replay -DRETURNED=nullptr"),
                   {"npdr_simulator() returned NULL"}));
}

TEST_F(HostileLibraries, AnOpenThatFailsIsAnErrorWithItsWords) {
  EXPECT_TRUE(says(message("open-fails"), {"open() failed", "no such robot"}));
  EXPECT_TRUE(says(message("open-throws"), {"open() failed", "threw", "thrown out"}));
  EXPECT_TRUE(says(message("open-gives-nothing"), {"open() succeeded", "made no simulator"}));
}

TEST_F(HostileLibraries, ADescriptionThatIsNonsenseIsAnError) {
  EXPECT_TRUE(says(message("no-states"), {"describe() gives 0 states", "must be 1 to"}));
  EXPECT_TRUE(says(message("negative"), {"describe() gives -3 parameters"}));
  EXPECT_TRUE(says(message("null-list"), {"describe()", "states at NULL"}));
  EXPECT_TRUE(says(message("null-name"), {"describe() calls a parameter ''"}));
  EXPECT_TRUE(says(message("long-name"), {"describe()", "1 to 100 bytes"}));
  EXPECT_TRUE(says(message("control"), {"describe()", "must be text"}));
  EXPECT_TRUE(says(message("twice"), {"describe()", "two of the name 'a'"}));
  EXPECT_TRUE(says(message("nominal"), {"describe()", "'a' is 5", "[0, 2]"}));
  EXPECT_TRUE(says(message("nan"), {"describe()", "'a' is nan"}));
  EXPECT_TRUE(says(message("period"), {"describe()", "period -1"}));
  EXPECT_TRUE(says(message("long-error"), {"describe() failed", "eeee"}));
}

TEST_F(HostileLibraries, AReplayThatFailsIsAnErrorWithItsWords) {
  const auto replay = [](const std::string& what) {
    const LibrarySimulator simulator({*folder_ / "hostile.so", what});
    const std::vector<std::uint32_t> seeds = {3, 4};
    return simulator.replay(cut(rollouts(1, 5), 0), 1, RowMatrix::Ones(2, 2), seeds);
  };
  EXPECT_TRUE(says(bare(message_of<InputError>([&] { replay("replay-fails"); })),
                   {"replay() failed", "motor on fire"}));
  EXPECT_TRUE(says(bare(message_of<InputError>([&] { replay("replay-throws"); })),
                   {"replay() failed", "threw", "off by one"}));
  EXPECT_TRUE(says(message_of<Error>([&] { replay("status"); }), {"'hostile'", "status 77"}));
  EXPECT_EQ(replay("infinite").status[0], RolloutStatus::diverged);
  EXPECT_EQ(replay("").row(0)[0], 3.0f);
}

TEST_F(HostileLibraries, ACallThatLoopsEndsTheProgramAfterTheTimeLimit) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // OpenMP doesn't survive a fork
  const auto replay = [](const std::string& what, double b) {
    const LibrarySimulator simulator({*folder_ / "hostile.so", what, ".", 0.5});
    const RowMatrix theta = RowMatrix::Constant(1, 2, b);
    return simulator.replay(cut(rollouts(1, 5), 0), 1, theta, std::vector<std::uint32_t>{3});
  };
  EXPECT_EXIT(replay("replay-loops", 0.75), ::testing::ExitedWithCode(1),
              "hostile.so: replay\\(\\) hasn't returned after 0.5 s for 1 row, the first of "
              "which has a = 0.75, b = 0.75, seed = 3\n");
  EXPECT_EQ(replay("replay-loops", 0.25).row(0)[0], 3.0f);
  EXPECT_EXIT(replay("open-loops", 0.25), ::testing::ExitedWithCode(1),
              "hostile.so: open\\(\\) hasn't returned after 0.5 s\n");
  EXPECT_EXIT(replay("close-loops", 0.25), ::testing::ExitedWithCode(1),
              "hostile.so: close\\(\\) hasn't returned after 0.5 s\n");
}

TEST_F(HostileLibraries, CallsHaveATimeLimitEach) {
  const LibrarySimulator simulator({*folder_ / "hostile.so", "slow", ".", 0.5});
  const RowMatrix theta = RowMatrix::Ones(1, 2);
  for (int k = 0; k < 15; ++k) {  // 0.75 s
    const auto found =
        simulator.replay(cut(rollouts(1, 5), 0), 1, theta, std::vector<std::uint32_t>{3});
    EXPECT_EQ(found.row(0)[0], 3.0f);
  }
}

}  // namespace
}  // namespace npdr::sim
