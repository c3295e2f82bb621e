
#include <optional>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/cluster/batch_task.h"
#include "pipeline/cluster/submit.h"
#include "pipeline/config/study_reader.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

std::string one_method() {
  return pendulum_study("small")
      .with("simulate", {"shard_size = 50"})
      .method("NPE", {"num_simulations = 225"})
      .with("cluster",
            {"partition = \"short\"", "time = \"01:00:00\"", "setup = [\"module load gcc/12\"]",
             "scratch = \"$TMPDIR\"", "sbatch = [\"--qos=long\"]", "mail = \"me@example.org\"",
             "simulate = { cpus = 2, memory = \"500M\" }"});
}

class JobScripts : public FolderTest {
 protected:
  JobScripts() { plan_.words = {"my study.toml"}; }

  std::string script(Stage stage, const Job& job) const {
    Job complete = job;
    complete.nodes = {
        static_cast<std::size_t>(&plan_.node(stage, {"NPE", 1, 1}) - plan_.nodes.data())};
    return job_script({plan_, "/home/me/a b", "/opt/npdr", "/home/me/100%"}, complete);
  }

  Plan plan_ = make_plan(parse_study(one_method(), "s.toml"), WorkFolder(folder_ / "runs"));
};

TEST_F(JobScripts, OfAnArrayPackShardsAndEndAtTheLast) {
  Job array;
  array.tasks = {0, 1, 2};
  array.shards_per_task = 2;
  const std::string text = script(Stage::simulate, array);
  EXPECT_TRUE(has(
      text,
      {"#!/bin/bash\n", "#SBATCH --cpus-per-task=2\n#SBATCH --mem=500M\n#SBATCH --time=01:00:00\n",
       "#SBATCH --signal=B:USR1@120\n", "#SBATCH --chdir=\"/home/me/a b\"\n",
       "#SBATCH --output=/home/me/100%%/simulate-npe-seed-1-round-1-%A_%a.log\n",
       "sbatch --array=0-2 THIS_FILE\n", "module load gcc/12\n",
       "export NPDR_SCRATCH=\"$TMPDIR\"\n", "first=$((SLURM_ARRAY_TASK_ID * 2))\n",
       "last=$((first + 1 < 4 ? first + 1 : 4))\n",
       "exec /opt/npdr/npdr task -- /opt/npdr/npdr-simulate 'my study.toml' --artefact"}));
}

TEST_F(JobScripts, QuotePathsAsSbatchReadsThem) {
  Job job;
  job.nodes = {0};
  const std::string text = job_script({plan_, "/home/me/a#b\"c", "/opt/npdr", "/logs"}, job);
  EXPECT_TRUE(has(text, "#SBATCH --chdir=\"/home/me/a#b\\\"c\"\n"));
  EXPECT_THROW(job_script({plan_, "/home/me/a\\b", "/opt/npdr", "/logs"}, job), InputError);
}

TEST_F(JobScripts, OfOtherStagesRunTheirArtefacts) {
  const std::string text = script(Stage::infer, {});
  EXPECT_TRUE(has(
      text, {"#SBATCH --partition=short\n", "#SBATCH --cpus-per-task=1\n#SBATCH --time=01:00:00\n",
             "#SBATCH --mail-type=FAIL\n", "#SBATCH --qos=long\n",
             "exec /opt/npdr/npdr task -- /opt/npdr/npdr run 'my study.toml' \\\n  --artefact "}));
}

TEST(ClusterTable, TakesASitesKeysForDefaults) {
  ClusterConfig site;
  site.account = "lab";
  site.partition = "long";
  const Study study = parse_study(one_method(), "s.toml", {}, site);
  EXPECT_EQ(study.cluster.account, "lab");
  EXPECT_EQ(study.cluster.partition, "short");
}

TEST(ClusterTable, OptionsAskForResourcesAlone) {
  const auto parse = [](const std::string& option) {
    parse_study(one_method(), "s.toml", {"cluster.sbatch=[\"" + option + "\"]"});
  };
  const std::string bad =
      "--dependency=afterok:1;--comment=x;--comm=x;-a 1-3;-d1;--output=x;--out=x;-o/etc/x;"
      "-Ho/etc/x;--wrap=x;--export=x;--qos=long --output=x;-C big -ox;qos=long;--;-;--qos long;"
      "-C big;-C=big;--clusters=big;-Mbig";
  for (const std::string& option : split(bad, ';')) {
    EXPECT_THROW(parse(option), InputError) << option;
  }
  for (const char* option : {"--qos=long", "--hold", "-H", "--exclusive", "--constraint=[a|b]",
                             "-Cbig", "--gres=gpu:1"}) {
    EXPECT_NO_THROW(parse(option)) << option;
  }
}

class TaskLog : public FolderTest {
 protected:
  std::optional<TaskEnd> end_of(const std::string& text) const {
    return end_in_log(folder_.file("a.log", text));
  }
};

TEST_F(TaskLog, SaysWhyATaskEnded) {
  const auto end = end_of(begin_line("17_3", {"npdr-simulate", "a b.toml"}) +
                          "\nnpdr-simulate: a.toml: can't be opened\n" + end_line(2, 0.04) + "\n");
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_status, 2);
  EXPECT_EQ(end->words, "exit status 2 after 0.0 s: npdr-simulate: a.toml: can't be opened");
  const auto of_run = end_of(begin_line("17", {"npdr", "run"}) +
                             "\nnpdr: infer NPE, seed 1, round 1 failed (exit status 1):\n"
                             "    npdr-infer: the disk is full\n    log: runs/a.log\n" +
                             end_line(1, 2.0) + "\n");
  ASSERT_TRUE(of_run);
  EXPECT_EQ(of_run->words, "exit status 1 after 2.0 s: npdr-infer: the disk is full");
}

TEST_F(TaskLog, OfATaskThatWasKilledSaysNothing) {
  EXPECT_FALSE(end_in_log(folder_ / "none.log"));
  const std::string begin = begin_line("17_3", {"npdr-simulate"}) + "\n";
  EXPECT_FALSE(end_of(begin));
  EXPECT_FALSE(end_of(begin + end_line(75, 3.0) + "\n" + begin + "half a li"));
}

}  // namespace
}  // namespace npdr::pipeline
