#include "pipeline/cluster/job.h"

#include <filesystem>
#include <fstream>

#include "core/text.h"
#include "pipeline/cluster/job_tag.h"
#include "pipeline/cluster/submit.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/plan/completeness.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// Two seeds of two rounds of 200 simulations in shards of 50.
std::string two_seeds() {
  return pendulum_study("small")
      .with("study", {"seeds = [1, 2]"})
      .with("simulate", {"shard_size = 50"})
      .method("NPE", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 200"});
}

// Jobs of a study.
class JobsOfStudy : public FolderTest {
 protected:
  explicit JobsOfStudy(const std::string& study)
      : plan_(make_plan(parse_study(study, "s.toml"), WorkFolder(folder_ / "runs"))) {}

  static JobsInput input_of(const Plan& plan, Index shards_per_task = 2) {
    return {plan, std::nullopt, std::vector<InFlight>(plan.nodes.size()),
            std::vector<Index>(plan.nodes.size(), shards_per_task), 1001};
  }
  JobsInput input(Index shards_per_task = 2) const { return input_of(plan_, shards_per_task); }

  std::size_t index_of(Stage stage, const Use& use) const {
    return static_cast<std::size_t>(&plan_.node(stage, use) - plan_.nodes.data());
  }
  // The position of the first job that makes a node, or of that which is an array or isn't.
  static std::size_t maker_of(const std::vector<Job>& jobs, std::size_t node,
                              std::optional<bool> is_array = {}) {
    const auto makes = [&](const Job& job) {
      return std::ranges::count(job.nodes, node) > 0 &&
             job.is_array() == is_array.value_or(job.is_array());
    };
    const auto found = std::ranges::find_if(jobs, makes);
    EXPECT_NE(found, jobs.end()) << "no job makes " << node;
    return static_cast<std::size_t>(found - jobs.begin());
  }
  // All of them in a queue, with ids from 10 on.
  std::vector<QueuedTask> queued(const std::vector<Job>& jobs, const std::string& indices) const {
    std::vector<QueuedTask> tasks;
    for (std::size_t j = 0; j < jobs.size(); ++j) {
      const std::string line = std::to_string(j + 10) + (jobs[j].is_array() ? indices : "|N/A") +
                               "|PENDING|Dependency||" + tag_of(plan_, jobs[j]).text();
      for (const QueuedTask& task : parse_queued_tasks(line)) tasks.push_back(task);
    }
    EXPECT_TRUE(doomed_jobs(plan_, tasks).empty());
    return tasks;
  }
  QueuedTask task_of(const Job& job, const std::string& begin) const {
    return parse_queued_tasks(begin + tag_of(plan_, job).text()).front();
  }

  Plan plan_;
};

class Jobs : public JobsOfStudy {
 protected:
  Jobs() : JobsOfStudy(two_seeds()) {}

  void touch_shard(const Node& node, Index shard) const {
    const auto path = shards(plan_, node)[static_cast<std::size_t>(shard)].path;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << "x";
  }
};

TEST_F(Jobs, EveryMissingArtefactIsMadeByAJobAfterThoseThatItNeeds) {
  const auto jobs = make_jobs(input());
  std::vector<std::size_t> maker(plan_.nodes.size(), jobs.size());
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    for (const std::size_t need : jobs[j].needs) EXPECT_LT(need, j);
    for (const std::size_t i : jobs[j].nodes) maker[i] = std::min(maker[i], j);
  }
  for (std::size_t i = 0; i < plan_.nodes.size(); ++i) {
    ASSERT_LT(maker[i], jobs.size()) << plan_.nodes[i].label();
  }
}

TEST_F(Jobs, ARoundIsAnArrayThenAJobThatAlsoProposesTheNextRound) {
  const auto jobs = make_jobs(input());
  const std::size_t simulation = index_of(Stage::simulate, {"NPE", 1, 1});
  const std::size_t posterior = index_of(Stage::infer, {"NPE", 1, 1});
  const std::size_t proposal = index_of(Stage::propose, {"NPE", 1, 2});
  const std::size_t array = maker_of(jobs, simulation, true);
  const std::size_t training = maker_of(jobs, posterior, false);
  EXPECT_EQ(jobs[array].tasks, (std::vector<Index>{0, 1}));  // four shards, two a task
  EXPECT_EQ(jobs[training].nodes, (std::vector<std::size_t>{simulation, posterior, proposal}));
  EXPECT_EQ(jobs[training].needs, std::vector<std::size_t>{array});
  const std::size_t next = maker_of(jobs, index_of(Stage::simulate, {"NPE", 1, 2}), true);
  EXPECT_EQ(jobs[next].needs, std::vector<std::size_t>{training});
}

TEST_F(Jobs, OnlyShardsThatAreNeitherThereNorInFlightAreSubmitted) {
  const std::size_t simulation = index_of(Stage::simulate, {"NPE", 1, 1});
  JobsInput in = input(1);
  in.in_flight[simulation] = InFlight{{"17"}, 1, {2}};
  touch_shard(plan_.nodes[simulation], 0);
  const auto jobs = make_jobs(in);
  EXPECT_EQ(jobs[maker_of(jobs, simulation, true)].first_task, 1);
  EXPECT_EQ(jobs[maker_of(jobs, simulation, true)].tasks, (std::vector<Index>{0, 2}));
  const Job& training = jobs[maker_of(jobs, index_of(Stage::infer, {"NPE", 1, 1}), false)];
  EXPECT_EQ(training.after_any, std::vector<std::string>{"17"});
  EXPECT_EQ(training.needs.size(), 1u);
}

TEST_F(Jobs, ShardsThatAreAllThereAreJoined) {
  const std::size_t simulation = index_of(Stage::simulate, {"NPE", 1, 1});
  for (Index shard = 0; shard < 4; ++shard) touch_shard(plan_.nodes[simulation], shard);
  const auto jobs = make_jobs(input());
  const std::size_t join = maker_of(jobs, simulation, false);
  EXPECT_EQ(jobs[join].nodes, std::vector<std::size_t>{simulation});
  EXPECT_EQ(jobs[maker_of(jobs, index_of(Stage::infer, {"NPE", 1, 1}), false)].needs,
            std::vector<std::size_t>{join});
}

TEST_F(Jobs, WhatIsInFlightIsntSubmittedAgainButWaitedFor) {
  const std::size_t posterior = index_of(Stage::infer, {"NPE", 2, 1});
  JobsInput in = input();
  in.in_flight[posterior] = InFlight{{"23"}};
  in.in_flight[index_of(Stage::propose, {"NPE", 2, 2})] = InFlight{{"23"}};
  const auto jobs = make_jobs(in);
  for (const Job& job : jobs) {
    EXPECT_EQ(std::ranges::count(job.nodes, posterior), 0);
  }
  const Job& next = jobs[maker_of(jobs, index_of(Stage::simulate, {"NPE", 2, 2}), true)];
  EXPECT_EQ(next.after_ok, std::vector<std::string>{"23"});
}

TEST_F(Jobs, LargeArraysAreSplit) {
  JobsInput in = input(1);
  in.max_array_size = 3;
  const auto jobs = make_jobs(in);
  const std::size_t simulation = index_of(Stage::simulate, {"NPE", 1, 1});
  std::vector<Index> shards;
  for (const Job& job : jobs) {
    if (!job.is_array() || job.nodes.front() != simulation) continue;
    for (const Index task : job.tasks) {
      EXPECT_LT(task, 3);
      shards.push_back(job.first_task + task);
    }
  }
  EXPECT_EQ(shards, (std::vector<Index>{0, 1, 2, 3}));
}

TEST_F(Jobs, CommentsOfTheQueueTellWhatIsInFlight) {
  const auto jobs = make_jobs(input());
  const std::size_t simulation = index_of(Stage::simulate, {"NPE", 1, 2});
  const Job& array = jobs[maker_of(jobs, simulation, true)];
  const std::vector<QueuedTask> tasks = {
      task_of(array, "40|1|RUNNING|None|n2|"),
      parse_queued_tasks("41|N/A|PENDING|Priority||somebody's own | job").front()};
  const auto flying = in_flight(plan_, tasks);
  EXPECT_EQ(flying[simulation].jobs, std::vector<std::string>{"40"});
  EXPECT_EQ(flying[simulation].shards, (std::set<Index>{2, 3}));
  EXPECT_EQ(tasks_of(plan_, tasks).size(), 1u);
  EXPECT_EQ(tasks.front().id(), "40_1");
  const Plan other =
      make_plan(parse_study(two_seeds(), "s.toml"), WorkFolder(folder_ / "elsewhere"));
  EXPECT_TRUE(tasks_of(other, {tasks.front()}).empty()) << "of another work folder";
}

TEST_F(Jobs, CommentsOfManySeedsAreShortEnoughForSlurm) {
  Study study = plan_.study;
  study.seeds.clear();
  for (std::uint64_t seed = 1; seed <= 100; ++seed) study.seeds.push_back(seed);
  const Plan plan = make_plan(study, plan_.work);
  const auto jobs = make_jobs(input_of(plan));
  std::size_t longest = 0;
  for (const Job& job : jobs) longest = std::max(longest, tag_of(plan, job).text().size());
  EXPECT_GT(longest, 512u);
  EXPECT_LE(longest, 1024u);
}

// Task 1 of an array has failed while task 0 runs: what waits for all of it waits in vain.
TEST_F(Jobs, ThatWaitForAFailedTaskAreDoomed) {
  const auto jobs = make_jobs(input());
  std::vector<QueuedTask> tasks = queued(jobs, "|0-1");
  const auto job_of = [&](Stage stage, const Use& use) {
    const bool is_array = stage == Stage::simulate;
    return std::to_string(maker_of(jobs, index_of(stage, use), is_array) + 10);
  };
  const std::string array = job_of(Stage::simulate, {"NPE", 1, 1});
  std::erase_if(tasks, [&](const QueuedTask& task) { return task.id() == array + "_1"; });
  for (QueuedTask& task : tasks) {
    if (task.job == array) task.state = "RUNNING";
  }
  const auto doomed = doomed_jobs(plan_, tasks);
  const auto is_doomed = [&](Stage stage, const Use& use) {
    return std::ranges::count(doomed, job_of(stage, use)) == 1;
  };
  EXPECT_TRUE(is_doomed(Stage::infer, {"NPE", 1, 1}));
  EXPECT_TRUE(is_doomed(Stage::simulate, {"NPE", 1, 2}));
  EXPECT_TRUE(is_doomed(Stage::evaluate, {"NPE", 1, 2}));
  EXPECT_FALSE(is_doomed(Stage::simulate, {"NPE", 1, 1}));
  EXPECT_FALSE(is_doomed(Stage::infer, {"NPE", 2, 1}));
}

class PolicyJobs : public JobsOfStudy {
 protected:
  PolicyJobs()
      : JobsOfStudy(furuta_study("loop")
                        .method("NPE", {"num_iterations = 2"})
                        .with("policy", {})
                        .with("cluster.policy", {"cpus = 7"})) {}
};

TEST_F(PolicyJobs, TheNextIterationWaitsForTheRolloutsThatAPolicyCollects) {
  const std::vector<Job> jobs = make_jobs(input(1));
  const auto maker = [&](Stage stage, const Use& use) {
    return maker_of(jobs, index_of(stage, use));
  };
  const auto waits_for = [&](std::size_t job, std::size_t other) {
    return std::ranges::count(jobs[job].needs, other) == 1;
  };
  const std::size_t search = maker(Stage::policy, {"NPE", 1, 0, 1});
  const std::size_t collection = maker(Stage::target, {"NPE", 1, 0, 2});
  EXPECT_TRUE(waits_for(search, maker(Stage::infer, {"NPE", 1, 1, 1})));
  EXPECT_TRUE(waits_for(collection, search));
  EXPECT_TRUE(waits_for(maker(Stage::simulate, {"NPE", 1, 1, 2}), collection));
  for (const Stage stage : {stage_of(plan_, jobs[search]), Stage::policy_test}) {
    EXPECT_EQ(resources_of(plan_.study.cluster, stage).cpus, 7);
  }
  EXPECT_EQ(resources_of(plan_.study.cluster, Stage::report).cpus, 1);
}

// A refinement that starts from another posterior, with helpers.
std::string helped_study(int refine_tasks) {
  return pendulum_study("small")
      .with("observation_noise", {"scale = 0.1"})
      .method("NPE", {"num_simulations = 200"})
      .method("Refined", {"algorithm = \"refine\"", "refine = { start = \"NPE\" }"})
      .with("cluster.simulate", {"cpus = 5"})
      .with("cluster", {"refine_tasks = " + std::to_string(refine_tasks)});
}

class HelperJobs : public JobsOfStudy {
 protected:
  HelperJobs() : JobsOfStudy(helped_study(3)) {}

  static std::vector<Job> helpers_of(const std::vector<Job>& jobs) {
    std::vector<Job> helpers;
    std::ranges::copy_if(jobs, std::back_inserter(helpers), &Job::is_helper);
    return helpers;
  }

  std::size_t refinement_ = index_of(Stage::infer, {"Refined", 1, 1});
};

TEST_F(HelperJobs, AreAnArrayBesideARefinementThatNothingWaitsFor) {
  const auto jobs = make_jobs(input());
  const auto is_its = [&](const Job& job) {
    return !job.is_helper() && std::ranges::count(job.nodes, refinement_) == 1;
  };
  const auto its = std::ranges::find_if(jobs, is_its);
  const auto helpers = std::ranges::find_if(jobs, &Job::is_helper);
  ASSERT_NE(its, jobs.end());
  ASSERT_NE(helpers, jobs.end());
  EXPECT_EQ(helpers_of(jobs).size(), 1u);
  EXPECT_TRUE(helpers->is_array());
  EXPECT_EQ(helpers->tasks, (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(helpers->nodes, std::vector<std::size_t>{refinement_});
  EXPECT_EQ(helpers->needs, its->needs);
  EXPECT_EQ(helpers->helps,
            (std::vector<std::size_t>{static_cast<std::size_t>(its - jobs.begin())}));
  const auto position = static_cast<std::size_t>(helpers - jobs.begin());
  for (const Job& job : jobs) EXPECT_EQ(std::ranges::count(job.needs, position), 0);
  EXPECT_EQ(stage_of(plan_, *helpers), Stage::simulate);
  EXPECT_EQ(label_of(plan_, *helpers), "help infer Refined, seed 1, round 1");
  const Plan alone = make_plan(parse_study(helped_study(0), "s.toml"), plan_.work);
  EXPECT_TRUE(helpers_of(make_jobs(input_of(alone))).empty()) << "none are wanted";
}

TEST_F(HelperJobs, RunTheirPartOfTheRefinement) {
  const auto jobs = make_jobs(input());
  const auto helpers = helpers_of(jobs);
  ASSERT_EQ(helpers.size(), 1u);
  const ScriptContext context{plan_, "/here", "/programs", "/logs"};
  const std::string script = job_script(context, helpers.front());
  EXPECT_TRUE(
      has(script, {"--job-name=npdr-small-help\n", "--cpus-per-task=5\n", "/help-infer-refined",
                   "%A_%a.log", "npdr-simulate", plan_.nodes[refinement_].key,
                   "--helper \"$((SLURM_ARRAY_TASK_ID + 1))/3\"\n"}));
  EXPECT_FALSE(has(script, " run "));
  // The refinement's job knows how many there are, also where the site's file says it.
  const std::string refinement = job_script(context, jobs[helpers.front().helps.front()]);
  EXPECT_TRUE(has(refinement, "--set cluster.refine_tasks=3"));
}

TEST_F(HelperJobs, MakeNothingThatIsInFlight) {
  const auto jobs = make_jobs(input());
  const QueuedTask helper = task_of(helpers_of(jobs).front(), "40|1|RUNNING|None|n2|");
  EXPECT_EQ(tasks_of(plan_, {helper}).size(), 1u) << "npdr cancel ends it";
  const auto flying = in_flight(plan_, {helper});
  EXPECT_TRUE(std::ranges::none_of(flying, &InFlight::is_made));
  EXPECT_EQ(flying[refinement_].helpers, std::set<std::string>{"40"});
  EXPECT_TRUE(parse_tag(helper.comment)->is_helper);
}

TEST_F(HelperJobs, ThatAreQueuedArentSubmittedAgain) {
  JobsInput in = input();
  in.in_flight[refinement_].helpers = {"40"};
  EXPECT_TRUE(helpers_of(make_jobs(in)).empty());
  // Helpers have gone, the refinement hasn't.
  in.in_flight[refinement_] = InFlight{{"23"}};
  const auto helpers = helpers_of(make_jobs(in));
  ASSERT_EQ(helpers.size(), 1u);
  EXPECT_EQ(helpers.front().helps_queued, std::vector<std::string>{"23"});
  EXPECT_EQ(sbatch_command({"s.sh", "0-2", {"7"}, {}, {}, {"23"}}),
            (std::vector<std::string>{"sbatch", "--parsable", "--array=0-2",
                                      "--dependency=afterok:7,after:23", "s.sh"}));
}

TEST_F(HelperJobs, OfARefinementThatWillNeverBeginAreDoomed) {
  const auto jobs = make_jobs(input());
  std::vector<QueuedTask> tasks = queued(jobs, "|0-2");
  const auto position = std::ranges::find_if(jobs, &Job::is_helper) - jobs.begin();
  const std::string start =
      std::to_string(jobs[static_cast<std::size_t>(position)].needs.front() + 10);
  std::erase_if(tasks, [&](const QueuedTask& task) { return task.job == start; });
  EXPECT_EQ(std::ranges::count(doomed_jobs(plan_, tasks), std::to_string(position + 10)), 1);
}

TEST(QueuedTasks, OfAnArrayThatWaitsStandInOneLine) {
  const auto tasks = parse_queued_tasks("40|1,5-6,10-20:5%4|PENDING|Priority||c");
  ASSERT_EQ(tasks.size(), 6u);
  EXPECT_EQ(tasks.front().id(), "40_1");
  EXPECT_EQ(tasks.back().id(), "40_20");
  EXPECT_EQ(parse_queued_tasks("17|N/A|RUNNING|None|n1|").front().id(), "17");
  for (const char* text : {"", "a|b", "x|1|R|N|n|c", "(null)"}) {
    EXPECT_TRUE(parse_queued_tasks(text).empty()) << text;
  }
  EXPECT_TRUE(parse_indices("1-").empty());
  EXPECT_TRUE(parse_indices("5-9:0").empty());
}

}  // namespace
}  // namespace npdr::pipeline
