// Refinements with helpers beside them: processes that come, go, and are killed.
#include <fmt/format.h>

#include <cmath>

#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/refinement_file.h"
#include "tests/cli/program.h"
#include "tests/sim/library/compiled_library.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

class Helpers : public ::testing::Test {
 protected:
  void SetUp() override {
    refine_alone(furuta_study("small")
                     .with("target", {"num_rollouts = 6"})
                     .with("simulator", {"store_every = 20"})
                     .with("observation_noise", {"scale = 0.05"})
                     .with("simulate", {"shard_size = 50"})
                     .method("Refined", {"algorithm = \"refine\"",
                                         "refine = { level_size = 1000, min_ess = 2500, "
                                         "max_simulations = 3000 }"})
                     .with("cluster", {"refine_tasks = 2"}));
  }

  void refine_alone(const StudyText& study) {
    std::ofstream(folder_ / "small.toml") << study;
    const Outcome alone = run(folder_.path(), inference("alone"));
    ASSERT_EQ(alone.status, 0) << alone.err;
    reference_ = digests(folder_ / "alone/small");
    for (const std::string& name : files_ending(folder_ / "alone/.cache/infer", ".h5")) {
      key_ = fs::path(name).stem();
    }
  }

  static std::vector<std::string> inference(const std::string& work) {
    return {"npdr", "run", "small.toml", "--until", "infer", "--work", work};
  }
  std::vector<std::string> help(const std::string& helper, const std::string& work) const {
    return {"npdr-simulate", "small.toml", "--artefact", key_.substr(0, 12),
            "--helper",      helper,       "--work",     work};
  }

  // A helper of a refinement that hasn't begun.
  Program begin_helper(const std::string& helper, const std::string& work) const {
    run(folder_.path(), {"npdr", "run", "small.toml", "--until", "target", "--work", work});
    const std::string name = helper.substr(0, 1);
    Program program(folder_.path(), help(helper, work), {"out" + name, "err" + name});
    EXPECT_TRUE(comes_true([&] { return fs::exists(rows_folder(work)) || program.has_ended(); }));
    return program;
  }

  fs::path rows_folder(const std::string& work) const {
    return folder_ / work / ".cache/infer" / (key_ + ".rows");
  }
  bool has_rows(const std::string& work) const {
    const std::set<std::string> names = files_ending(rows_folder(work), ".h5");
    return std::ranges::any_of(names, [](const auto& name) { return name.starts_with("rows-"); });
  }

  void expect_same_bits(const std::string& work) const {
    EXPECT_EQ(digests(folder_ / work / "small"), reference_);
    EXPECT_FALSE(fs::exists(rows_folder(work)));
  }
  static void expect_help(const Outcome& helper) {
    EXPECT_EQ(helper.status, 0) << helper.err;
    EXPECT_TRUE(has(helper.out, "helped with "));
    EXPECT_FALSE(has(helper.out, "helped with 0 rows"));
  }

  TempFolder folder_;
  std::string key_;
  std::map<std::string, std::string> reference_;
};

TEST_F(Helpers, GiveTheSameBits) {
  const Program only = begin_helper("1/1", "one");
  EXPECT_EQ(run(folder_.path(), inference("one")).status, 0);
  expect_help(only.wait());
  expect_same_bits("one");

  const Program first = begin_helper("1/2", "two"), second = begin_helper("2/2", "two");
  EXPECT_EQ(run(folder_.path(), inference("two")).status, 0);
  expect_help(first.wait());
  expect_help(second.wait());
  expect_same_bits("two");
  const Outcome late = run(folder_.path(), help("1/1", "two"));
  EXPECT_EQ(late.status, 0);
  EXPECT_TRUE(has(late.out, "helped with 0 rows"));
}

TEST_F(Helpers, WaitForWhatTheRefinementNeeds) {
  const Program helper(folder_.path(), help("1/1", "early"), {"out1", "err1"});
  EXPECT_TRUE(comes_true([&] {
    return text_of(folder_ / "err1").find("waits for what it starts from") != std::string::npos;
  }));
  EXPECT_EQ(run(folder_.path(), inference("early")).status, 0);
  const Outcome outcome = helper.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  expect_same_bits("early");
}

TEST_F(Helpers, MayBeKilledOrComeLate) {
  const Program first = begin_helper("1/2", "killed");
  const Program refinement(folder_.path(), inference("killed"), {"out", "err"});
  EXPECT_TRUE(comes_true([&] { return has_rows("killed") || refinement.has_ended(); }));
  EXPECT_FALSE(refinement.has_ended() || first.has_ended()) << "a kill must meet both at work";
  first.send(SIGKILL);
  first.wait();
  const Program second(folder_.path(), help("2/2", "killed"), {"out2", "err2"});
  EXPECT_EQ(refinement.wait().status, 0);
  EXPECT_EQ(second.wait().status, 0);
  expect_same_bits("killed");
}

TEST_F(Helpers, AlsoSimulateWhatPredictsLeftOutRollouts) {
  const auto with_power = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--set", "method.refine.cross_validate=true"});
    return words;
  };
  ASSERT_EQ(run(folder_.path(), with_power(inference("power-alone"))).status, 0);
  run(folder_.path(), {"npdr", "run", "small.toml", "--until", "target", "--work", "power"});
  for (const std::string& name : files_ending(folder_ / "power-alone/.cache/infer", ".h5")) {
    key_ = fs::path(name).stem();
  }
  const Program helper(folder_.path(), with_power(help("1/1", "power")), {"out1", "err1"});
  EXPECT_TRUE(comes_true([&] { return fs::exists(rows_folder("power")) || helper.has_ended(); }));
  // Ended in between, the refinement finds what has been simulated for it.
  for (const int signal : {SIGTERM, SIGKILL, SIGTERM}) {
    const Program refinement(folder_.path(), with_power(inference("power")), {"out", "err"});
    EXPECT_TRUE(comes_true([&] { return has_rows("power") || refinement.has_ended(); }));
    EXPECT_FALSE(refinement.ends_within(0.3)) << "a signal must meet it at work";
    refinement.send(signal);
    refinement.wait();
  }
  EXPECT_EQ(run(folder_.path(), with_power(inference("power"))).status, 0);
  expect_help(helper.wait());
  EXPECT_EQ(digests(folder_ / "power/small"), digests(folder_ / "power-alone/small"));
}

TEST_F(Helpers, StopOnRequest) {
  const Program helper = begin_helper("1/1", "stopped");
  helper.send(SIGTERM);
  EXPECT_EQ(helper.wait().status, 75);
}

// The refinement's likelihoods are kept for it, whatever ends it.
TEST_F(Helpers, OutliveTheRefinement) {
  for (const int signal : {SIGKILL, SIGTERM}) {
    const std::string work = "ended-" + std::to_string(signal);
    const Program helper = begin_helper("1/1", work);
    for (int i = 0; i < 4; ++i) {
      const Program refinement(folder_.path(), inference(work), {"out", "err"});
      EXPECT_TRUE(comes_true([&] { return has_rows(work) || refinement.has_ended(); }));
      EXPECT_FALSE(refinement.ends_within(0.1 * i)) << "a signal must meet it at work";
      refinement.send(signal);
      refinement.wait();
    }
    const Outcome last = run(folder_.path(), inference(work));
    EXPECT_EQ(last.status, 0) << last.err;
    expect_help(helper.wait());
    expect_same_bits(work);
  }
}

// A mass on a spring that is let go at rest, whose first states are moved while it is refined: what
// has been simulated from others counts no more.
class HelpersOfFirstStates : public Helpers {
 protected:
  void SetUp() override {
    sim::compile_library(sim::spring_source(), folder_ / "spring.so");
    write_recording(recorded(), folder_ / "recording.h5");
    refine_alone(StudyText("small")
                     .with("target", {"recording = \"recording.h5\"", "num_rollouts = 4"})
                     .with("simulator", {"library = \"spring.so\""})
                     .with("prior", {"stiffness = { uniform = [10.0, 30.0] }",
                                     "friction = { uniform = [0.0, 1.0] }"})
                     .with("observation_noise", {"scale_prior = [0.1, 1.0]"})
                     .with("simulate", {"shard_size = 50"})
                     .method("Refined", {"algorithm = \"refine\"",
                                         "refine = { level_size = 1000, min_ess = 200, "
                                         "infer_first_states = true }"})
                     .with("cluster", {"refine_tasks = 1"}));
  }

  static Target recorded() {
    constexpr Index steps = 60;
    constexpr double dt = 0.01, h = dt / 10, noise = 0.01;
    Target target{dt, {{"q", "m"}, {"v", "m/s"}}, {{"force", "N"}}, {}, "test"};
    Stream stream({12, "helpers_test", 0, 0, 0});
    for (const double begin : {0.3, -0.25, 0.2, -0.35}) {
      RowMatrix states(steps + 1, 2);
      double q = begin, v = 0.0;
      for (Index t = 0; t <= steps; ++t) {
        states.row(t) << q + noise * stream.normal(), v + 4.0 * noise * stream.normal();
        for (int k = 0; k < 10; ++k) {
          v += h * (-18.0 * q - 0.3 * v - 0.5 * std::tanh(100.0 * v));
          q += h * v;
        }
      }
      target.rollouts.push_back({fmt::format("from {}", begin), states, RowMatrix::Zero(steps, 1)});
    }
    return target;
  }
};

TEST_F(HelpersOfFirstStates, GiveTheSameBits) {
  const h5::File alone = h5::File::open((folder_ / "alone/.cache/infer" / (key_ + ".h5")).string());
  EXPECT_GE(read_part<FirstStateMoves>(alone)->count, 1);
  const Program helper = begin_helper("1/1", "one");
  EXPECT_EQ(run(folder_.path(), inference("one")).status, 0);
  expect_help(helper.wait());
  expect_same_bits("one");
  // Stopped again and again, each time with a checkpoint.
  for (int i = 0; i < 6; ++i) {
    const Program refinement(folder_.path(), inference("stopped"), {"out", "err"});
    const bool has_ended = refinement.ends_within(0.3 + 0.15 * i);
    EXPECT_FALSE(i == 0 && has_ended) << "a signal must meet it at work";
    refinement.send(SIGTERM);
    refinement.wait();
  }
  EXPECT_EQ(run(folder_.path(), inference("stopped")).status, 0);
  expect_same_bits("stopped");
}

TEST_F(Helpers, SayWhatIsWrong) {
  const auto expect = [&](std::vector<std::string> words, const char* message) {
    words.insert(words.begin(), {"npdr-simulate", "small.toml", "--work", "alone"});
    const Outcome outcome = run(folder_.path(), words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_TRUE(has(outcome.err, message));
  };
  for (const char* helper : {"1", "0/2", "3/2", "1/2/3", "x/2", "1/1001"}) {
    expect({"--artefact", key_, "--helper", helper}, "must be I/N with 1 <= I <= N <= 1000");
  }
  expect({"--helper", "1/2"}, "must come with --artefact KEY");
  expect({"--helper", "1/2", "--artefact", key_, "--shard", "1"}, "without --shard");
  std::string target;
  for (const std::string& name : files_ending(folder_ / "alone/.cache/target", ".h5")) {
    target = fs::path(name).stem();
  }
  expect({"--helper", "1/2", "--artefact", target}, "has no rows to help with");
  EXPECT_TRUE(has(run(folder_.path(), {"npdr-simulate", "--help"}).out, "--helper"));
  run(folder_.path(), {"npdr", "run", "small.toml", "--until", "target", "--work", "new"});
  const Outcome tasks = run(folder_.path(), {"npdr", "tasks", "small.toml", "--work", "new"});
  EXPECT_TRUE(has(tasks.out, "--helper 2/2"));
}

}  // namespace
}  // namespace npdr::pipeline
