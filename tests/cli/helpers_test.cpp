// Refinements with helpers beside them: processes that come, go, and are killed.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/refinement_file.h"
#include "tests/cli/program.h"
#include "tests/sim/library/compiled_library.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

// What a refinement gives alone, which each suite makes once.
class Helpers : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
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
  static void TearDownTestSuite() { delete folder_; }

  static void refine_alone(const StudyText& study) {
    folder_->file("small.toml", study);
    refine("alone");
    reference_ = digests(file("alone/small"));
    key_ = key_of("infer", "alone");
  }

  static fs::path file(const std::string& name) { return folder_->path() / name; }
  static std::string key_of(const std::string& stage, const std::string& work) {
    const std::set<std::string> names = files_ending(file(work) / ".cache" / stage, ".h5");
    return names.empty() ? "" : fs::path(*names.rbegin()).stem();
  }

  using Words = std::vector<std::string>;
  static Words inference(const std::string& work, const std::string& until = "infer") {
    return {"npdr", "run", "small.toml", "--until", until, "--work", work};
  }
  static Words help(const std::string& helper, const std::string& work) {
    return {"npdr-simulate", "small.toml", "--artefact", key_.substr(0, 12),
            "--helper",      helper,       "--work",     work};
  }
  static void refine(const std::string& work, const Words& more = {}) {
    with_status(0, run(folder_->path(), joined(inference(work), more)));
  }
  // Ends a refinement that is at work by a signal, `seconds` after some rows are there.
  static void begin_and_end(const std::string& work, int signal, double seconds,
                            const Words& more = {}) {
    const Program refinement(folder_->path(), joined(inference(work), more), {"out", "err"});
    EXPECT_TRUE(comes_true([&] { return has_rows(work) || refinement.has_ended(); }));
    EXPECT_FALSE(refinement.ends_within(seconds)) << "a signal must meet it at work";
    refinement.send(signal);
    refinement.wait();
  }

  // A helper of a refinement that hasn't begun.
  static Program begin_helper(const std::string& helper, const std::string& work,
                              const Words& more = {}) {
    run(folder_->path(), inference(work, "target"));
    const std::string name = helper.substr(0, 1);
    Program program(folder_->path(), joined(help(helper, work), more),
                    {"out" + name, "err" + name});
    EXPECT_TRUE(comes_true([&] { return fs::exists(rows_folder(work)) || program.has_ended(); }));
    return program;
  }

  static fs::path rows_folder(const std::string& work) {
    return file(work) / ".cache/infer" / (key_ + ".rows");
  }
  static bool has_rows(const std::string& work) {
    const std::set<std::string> names = files_ending(rows_folder(work), ".h5");
    return std::ranges::any_of(names, [](const auto& name) { return name.starts_with("rows-"); });
  }

  static void expect_same_bits(const std::string& work) {
    EXPECT_EQ(digests(file(work) / "small"), reference_);
    EXPECT_FALSE(fs::exists(rows_folder(work)));
  }
  static void expect_help(const Outcome& helper) {
    EXPECT_EQ(helper.status, 0) << helper.err;
    EXPECT_TRUE(has(helper.out, "helped with "));
    EXPECT_FALSE(has(helper.out, "helped with 0 rows"));
  }

  inline static TempFolder* folder_ = nullptr;
  inline static std::string key_;
  inline static std::map<std::string, std::string> reference_;
};

TEST_F(Helpers, GiveTheSameBits) {
  const Program only = begin_helper("1/1", "one");
  refine("one");
  expect_help(only.wait());
  expect_same_bits("one");

  const Program first = begin_helper("1/2", "two"), second = begin_helper("2/2", "two");
  refine("two");
  expect_help(first.wait());
  expect_help(second.wait());
  expect_same_bits("two");
  EXPECT_TRUE(
      has(with_status(0, run(folder_->path(), help("1/1", "two"))).out, "helped with 0 rows"));
}

TEST_F(Helpers, WaitForWhatTheRefinementNeeds) {
  const Program helper(folder_->path(), help("1/1", "early"), {"out1", "err1"});
  EXPECT_TRUE(
      comes_true([&] { return has(text_of(file("err1")), "waits for what it starts from"); }));
  refine("early");
  with_status(0, helper.wait());
  expect_same_bits("early");
}

TEST_F(Helpers, MayBeKilledOrComeLate) {
  const Program first = begin_helper("1/2", "killed");
  const Program refinement(folder_->path(), inference("killed"), {"out", "err"});
  EXPECT_TRUE(comes_true([&] { return has_rows("killed") || refinement.has_ended(); }));
  EXPECT_FALSE(refinement.has_ended() || first.has_ended()) << "a kill must meet both at work";
  first.send(SIGKILL);
  first.wait();
  const Program second(folder_->path(), help("2/2", "killed"), {"out2", "err2"});
  EXPECT_EQ(refinement.wait().status, 0);
  EXPECT_EQ(second.wait().status, 0);
  expect_same_bits("killed");
}

TEST_F(Helpers, AlsoSimulateWhatPredictsLeftOutRollouts) {
  const Words power = {"--set", "method.refine.cross_validate=true"};
  refine("power-alone", power);
  const std::string key = std::exchange(key_, key_of("infer", "power-alone"));
  const Program helper = begin_helper("1/1", "power", power);
  // Ended in between, the refinement finds what has been simulated for it.
  for (const int signal : {SIGTERM, SIGKILL, SIGTERM}) begin_and_end("power", signal, 0.3, power);
  refine("power", power);
  expect_help(helper.wait());
  EXPECT_EQ(digests(file("power/small")), digests(file("power-alone/small")));
  key_ = key;
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
    for (int i = 0; i < 4; ++i) begin_and_end(work, signal, 0.1 * i);
    refine(work);
    expect_help(helper.wait());
    expect_same_bits(work);
  }
}

// A mass on a spring that is let go at rest, whose first states are moved while it is refined: what
// has been simulated from others counts no more.
class HelpersOfFirstStates : public Helpers {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    sim::compile_library(sim::spring_source(), file("spring.so"));
    write_recording(recorded(), file("recording.h5"));
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
                     .with("cluster", {"refine_tasks = 1"})
                     .with("evaluate", {"floor = false"}));
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
  const h5::File alone = h5::File::open(file("alone/.cache/infer") / (key_ + ".h5"));
  EXPECT_GE(read_part<FirstStateMoves>(alone)->count, 1);
  const Program helper = begin_helper("1/1", "one");
  refine("one");
  expect_help(helper.wait());
  expect_same_bits("one");
  // Stopped again and again, each time with a checkpoint.
  for (int i = 0; i < 4; ++i) {
    const Program refinement(folder_->path(), inference("stopped"), {"out", "err"});
    const bool has_ended = refinement.ends_within(0.3 + 0.15 * i);
    EXPECT_FALSE(i == 0 && has_ended) << "a signal must meet it at work";
    refinement.send(SIGTERM);
    refinement.wait();
  }
  refine("stopped");
  expect_same_bits("stopped");
}

TEST_F(Helpers, SayWhatIsWrong) {
  const auto expect = [&](std::vector<std::string> words, const char* message) {
    words = joined({"npdr-simulate", "small.toml", "--work", "alone"}, words);
    EXPECT_TRUE(has(with_status(2, run(folder_->path(), words)).err, message));
  };
  for (const char* helper : {"1", "0/2", "3/2", "1/2/3", "x/2", "1/1001"}) {
    expect({"--artefact", key_, "--helper", helper}, "must be I/N with 1 <= I <= N <= 1000");
  }
  expect({"--helper", "1/2"}, "must come with --artefact KEY");
  expect({"--helper", "1/2", "--artefact", key_, "--shard", "1"}, "without --shard");
  expect({"--helper", "1/2", "--artefact", key_of("target", "alone")}, "has no rows to help with");
  EXPECT_TRUE(has(run(folder_->path(), {"npdr-simulate", "--help"}).out, "--helper"));
  run(folder_->path(), inference("new", "target"));
  EXPECT_TRUE(has(run(folder_->path(), {"npdr", "tasks", "small.toml", "--work", "new"}).out,
                  "--helper 2/2"));
}

}  // namespace
}  // namespace npdr::pipeline
