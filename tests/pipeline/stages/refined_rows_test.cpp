// Rows of refinements: shared with helpers, or of programs of the user.

#include <algorithm>
#include <numeric>
#include <sstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/plan/plan.h"
#include "pipeline/run/run_stage.h"
#include "pipeline/stages/refined_rows.h"
#include "pipeline/stages/stages.h"
#include "tests/pipeline/small_study.h"
#include "tests/pipeline/stages/run_until.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

TEST(WalkingOrder, ComesByAllShardsItsOwnFirst) {
  for (const std::size_t num_shards : {1u, 2u, 7u, 100u}) {
    std::vector<int> first(num_shards, 0);
    for (Index number = 0; number < 4; ++number) {
      std::vector<std::size_t> order = walking_order(num_shards, {number, 3});
      const std::size_t own = num_shards * static_cast<std::size_t>(number + 1) / 4 -
                              num_shards * static_cast<std::size_t>(number) / 4;
      for (std::size_t i = 0; i < own; ++i) ++first[order[i]];
      EXPECT_TRUE(std::is_sorted(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(own)));
      std::ranges::sort(order);
      std::vector<std::size_t> all(num_shards);
      std::iota(all.begin(), all.end(), std::size_t{0});
      EXPECT_EQ(order, all);
    }
    EXPECT_EQ(first, std::vector<int>(num_shards, 1)) << "each is in one segment";
  }
}

TEST(WalkingOrder, WalkersThatAreDoneDontFollowEachOther) {
  const std::vector<std::size_t> a = walking_order(100, {1, 4}), b = walking_order(100, {2, 4});
  int num_same = 0;
  for (std::size_t i = 20; i < 100; ++i) num_same += a[i] == b[i] ? 1 : 0;
  EXPECT_LE(num_same, 10);
}

std::string study_text() {
  return pendulum_study("help")
      .with("simulator", {"store_every = 40"})
      .with("simulate", {"shard_size = 130"})
      .with("observation_noise", {"scale = 0.1"})
      .method("ABC", {"algorithm = \"abc\"", "num_simulations = 100"})
      .method("Refined", {"algorithm = \"refine\"",
                          "refine = { level_size = 1000, min_ess = 100, max_simulations = 4000 }"})
      .with("cluster", {"refine_tasks = 2"});
}

class RefinedRowsOfAStudy : public FolderTest {
 protected:
  RefinedRowsOfAStudy()
      : plan_(plan_of("runs")),
        node_(plan_.node(Stage::infer, {"Refined", 1, 1})),
        rows_(plan_.work.asked_rows(node_.key)) {
    run_until(plan_, Stage::target);
  }

  Plan plan_of(const std::string& work) const {
    return make_plan(parse_study(study_text(), "s.toml"), WorkFolder(folder_ / work));
  }
  std::string digest_alone() const {
    const Plan plan = plan_of("alone");
    run_until(plan, Stage::target);
    run_stage(plan, plan.node(Stage::infer, {"Refined", 1, 1}));
    return content_digest(plan.node(Stage::infer, {"Refined", 1, 1}).path);
  }
  std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(rows_)) found.insert(entry.path().filename());
    return found;
  }
  std::string error_of_helper() const {
    return message_of<InputError>([&] { help_refinement(plan_, node_, {1, 1}, 0.0); });
  }

  Plan plan_;
  const Node& node_;
  fs::path rows_;
};

TEST_F(RefinedRowsOfAStudy, AHelperGivesUpWithoutATarget) {
  const Plan plan = plan_of("empty");
  const Node& node = plan.node(Stage::infer, {"Refined", 1, 1});
  EXPECT_TRUE(says(message_of<InputError>([&] {
                     help_refinement(plan, node, {1, 1}, 0.0);
                   }),
                   {node.label(), "needs 'target", "npdr run"}));
}

TEST_F(RefinedRowsOfAStudy, HaveTheSameBitsInShards) {
  fs::create_directories(rows_);
  write_text_file(rows_ / "rows-0-130-0123456789abcdef.h5",
                  "of other rows, such as an older try's");
  write_text_file(rows_ / "asked-0-", "what isn't asked for");
  run_stage(plan_, node_);
  EXPECT_FALSE(fs::exists(rows_)) << "a complete refinement leaves nothing behind";
  EXPECT_EQ(content_digest(node_.path), digest_alone());
}

TEST_F(RefinedRowsOfAStudy, WhatIsAskedForIsSimulatedOnce) {
  SimulatedLikelihood likelihood(plan_, node_, {});
  const AskedRows asked{.first = 0, .shard_size = 17, .theta = RowMatrix::Constant(50, 2, 1.0)};
  kAskedRowsSchema.write(rows_ / asked.file_name(), node_.identity, asked);
  RefinedRows helper(plan_, node_, likelihood, {1, 1});
  EXPECT_EQ(helper.help([](Index) {}), 50);
  EXPECT_EQ(helper.help([](Index) {}), 0);
  // The refinement takes what is there, though it is another process's.
  RefinedRows refinement(plan_, node_, likelihood, {0, 2});
  const std::optional<SimulatedRows> together = refinement.ask(asked, [](Index) {});
  Index failed = 0;
  const sim::Trajectories alone = likelihood.simulate(asked.theta, 0);
  EXPECT_EQ(together->log_likelihood, likelihood.of(alone, failed));
  EXPECT_EQ(together->num_failed, failed);
  EXPECT_EQ(together->rollouts.num_rows, 0);
  EXPECT_FALSE(fs::exists(rows_ / asked.file_name()));
  EXPECT_EQ(helper.help([](Index) {}), 0) << "nothing is asked for any more";
  refinement.forget(49);
  EXPECT_FALSE(fs::is_empty(rows_)) << "the last rows aren't in a checkpoint";
  refinement.forget(50);
  EXPECT_TRUE(fs::is_empty(rows_));
  AskedRows wanted = asked;
  wanted.rollouts = true;
  const AskedRows killed{.first = 7, .theta = asked.theta};
  kAskedRowsSchema.write(rows_ / killed.file_name(), node_.identity, killed);
  EXPECT_EQ(refinement.ask(wanted, [](Index) {})->rollouts.values, alone.values);
  EXPECT_TRUE(names_of_asked_rows(names()).empty()) << "nobody waits for anything";
}

// As on a node without the simulator's license: what it says of all rows isn't taken for true.
TEST_F(RefinedRowsOfAStudy, RowsThatAllFailAreLeftToTheRefinement) {
  SimulatedLikelihood likelihood(plan_, node_, {});
  RowMatrix theta = RowMatrix::Constant(40, 2, 1.0);
  theta.topRows(21).setConstant(-1.0);  // no pendulum
  const AskedRows asked{.first = 0, .shard_size = 20, .theta = theta};
  kAskedRowsSchema.write(rows_ / asked.file_name(), node_.identity, asked);
  RefinedRows helper(plan_, node_, likelihood, {1, 1});
  EXPECT_EQ(helper.help([](Index) {}), 40);
  EXPECT_EQ(names().size(), 2u) << "the request, and the shard with rows that are possible";
  EXPECT_EQ(helper.help([](Index) {}), 0) << "once is enough";
  RefinedRows refinement(plan_, node_, likelihood, {0, 1});
  EXPECT_EQ(refinement.ask(asked, [](Index) {})->num_failed, 21);
}

TEST_F(RefinedRowsOfAStudy, CountTheirOwnWorkOnce) {
  SimulatedLikelihood likelihood(plan_, node_, {});
  const AskedRows asked{.first = 0, .shard_size = 17, .theta = RowMatrix::Constant(50, 2, 1.0)};
  fs::create_directories(rows_);
  RefinedRows alone(plan_, node_, likelihood, {0, 0});
  alone.ask(asked, [](Index) {});
  EXPECT_EQ(alone.cost_of_others().core_seconds, 0.0);
  EXPECT_EQ(alone.unread_core_seconds(), 0.0);
  // Who goes on from there takes it for the work of others, and who stops doesn't count it.
  RefinedRows next(plan_, node_, likelihood, {0, 0});
  next.ask(asked, [](Index) {});
  EXPECT_GT(next.cost_of_others().core_seconds, 0.0);
  next.forget(50);
  kAskedRowsSchema.write(rows_ / asked.file_name(), node_.identity, asked);
  RefinedRows stopped(plan_, node_, likelihood, {0, 1}), helper(plan_, node_, likelihood, {1, 1});
  EXPECT_EQ(stopped.help([](Index) {}), 50);
  EXPECT_GT(stopped.unread_core_seconds(), 0.0);
  next.forget(50);
  EXPECT_EQ(helper.help([](Index) {}), 50);
  EXPECT_EQ(helper.unread_core_seconds(), 0.0) << "nobody goes on from a helper";
}

TEST_F(RefinedRowsOfAStudy, SayWhatIsWrongWithThem) {
  AskedRows asked{.first = 0, .shard_size = 17, .theta = RowMatrix::Constant(50, 3, 1.0)};
  kAskedRowsSchema.write(rows_ / asked.file_name(), node_.identity, asked);
  const fs::path right = rows_ / asked.file_name(), wrong = rows_ / "asked-0-40-a.h5";
  EXPECT_TRUE(says(error_of_helper(), {right, "of 3 parameters", "of 2", "remove this file"}));
  fs::rename(right, wrong);
  EXPECT_TRUE(says(error_of_helper(), {wrong, "asks for asked-0-50-", "remove this file"}));
  write_text_file(wrong, "damaged");
  EXPECT_TRUE(has(error_of_helper(), wrong));
  fs::remove(wrong);
  asked.theta = RowMatrix::Constant(50, 2, 1.0);
  kAskedRowsSchema.write(rows_ / asked.file_name(), plan_.nodes.front().identity, asked);
  EXPECT_TRUE(has(error_of_helper(), node_.key)) << "of another artefact";
}

TEST_F(RefinedRowsOfAStudy, OnlyRefinementsAreHelped) {
  const Node& other = plan_.node(Stage::infer, {"ABC", 1, 1});
  EXPECT_TRUE(says(message_of<InputError>([&] {
                     run_helper(plan_, other, {1, 1});
                   }),
                   {other.label(), "no rows to help with", "algorithm 'refine'", "--dry-run"}));
  run_stage(plan_, node_);
  fs::create_directories(rows_);
  EXPECT_EQ(run_helper(plan_, node_, {1, 1}), 0) << "it is complete";
  EXPECT_FALSE(fs::exists(rows_));
}

// x = a, and no number where a > 0.97, or 0.5 once there is a file `bad`; a line with the number of
// its rows for each call.
constexpr const char* kSimulator = R"sh(
most=0.97; test ! -e bad || most=0.5
awk -F, -v most=$most 'NR > 1 { if ($1 > most) print "nan"; else print $1 } END { print NR - 1 >> "calls" }' "$1" > "$2"
)sh";

class RefinedPrograms : public FolderTest {
 protected:
  RefinedPrograms() {
    folder_.file("x_o.csv", "x\n0.96\n");
    folder_.file("simulate.sh", kSimulator);
  }

  Plan plan_of(const std::string& max_failed_fraction) const {
    const std::string text = command_study("program")
                                 .only("prior", {"a = { uniform = [0.0, 1.0] }"})
                                 .with("observation_noise", {"std = { x = 0.1 }"})
                                 .with("simulate", {"shard_size = 100"})
                                 .with("limits", {"max_failed_fraction = " + max_failed_fraction})
                                 .method("Prior", {"algorithm = \"refine\"",
                                                   "refine = { level_size = 1000, min_ess = 300 }"})
                                 .with("evaluate", {"num_samples = 20"});
    return make_plan(parse_study(text, folder_ / "s.toml"), WorkFolder(folder_ / "work"));
  }
};

// They begin after the simulations of the prior, which were fine.
TEST_F(RefinedPrograms, StopAtTooManyFailures) {
  const Plan plan = plan_of("0.05");
  const std::string message = message_of<FailedRolloutsError>(
      [&] {
        for (const Node& node : plan.nodes) {
          if (node.stage == Stage::infer) folder_.file("bad", "");
          run_stage(plan, node);
        }
      },
      &folder_);
  EXPECT_TRUE(has(message, "a refinement takes their parameters for impossible"));
}

// Between two calls a checkpoint can be written.
TEST_F(RefinedPrograms, AreCalledWithAShardAtMost) {
  run_until(plan_of("1"), Stage::evaluate);
  std::istringstream calls(text_of(folder_ / "calls"));
  Index most = 0;
  for (Index rows = 0; calls >> rows;) most = std::max(most, rows);
  EXPECT_GT(most, 0);
  EXPECT_LE(most, 100);
}

}  // namespace
}  // namespace npdr::pipeline
