#include "pipeline/cluster/job_script.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "pipeline/config/cluster_check.h"
#include "pipeline/config/study_reader.h"
#include "tests/message_of.h"
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

class JobScripts : public testing::Test {
 protected:
  JobScripts() { plan_.words = {"my study.toml"}; }

  std::string script(Stage stage, const Job& job) const {
    Job complete = job;
    complete.nodes = {
        static_cast<std::size_t>(&plan_.node(stage, {"NPE", 1, 1}) - plan_.nodes.data())};
    return job_script({plan_, "/home/me/a b", "/opt/npdr", "/home/me/100%"}, complete);
  }

  TempFolder folder_;
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

TEST(ClusterTable, IsCheckedAndASitesKeysAreDefaults) {
  const std::string text = one_method();
  ClusterConfig site;
  site.account = "lab";
  site.partition = "long";
  const Study study = parse_study(text, "s.toml", {}, site);
  EXPECT_EQ(study.cluster.account, "lab");
  EXPECT_EQ(study.cluster.partition, "short");
  EXPECT_TRUE(says(message_of<InputError>([&] {
                     parse_study(text, "s.toml",
                                 {"cluster.time=\"1 hour\"", "cluster.partition='a b'",
                                  "cluster.scratch='/tmp/\"x'"});
                   }),
                   {"--set cluster.partition='a b': cluster.partition = 'a b'",
                    "must be one word of printable characters without quotes",
                    "\n--set cluster.time=\"1 hour\": cluster.time = '1 hour'",
                    "must be a time such as 90 (minutes), 01:30:00 or 1-12:00 (days-hours:minutes)",
                    "\n--set cluster.scratch='/tmp/\"x': cluster.scratch = '/tmp/\"x'",
                    "must be one word of printable characters without quotes"}));
}

TEST(ClusterTable, ATimeLimitIsLongerThanTheWarningBeforeIt) {
  EXPECT_TRUE(says(
      message_of<InputError>([] { parse_study(one_method(), "s.toml", {"cluster.time=\"2\""}); }),
      {"--set cluster.time=\"2\": cluster.time = '2'",
       "must be longer than cluster.signal_seconds = 120"}));
  EXPECT_EQ(seconds_of("90"), 5400.0);
  EXPECT_EQ(seconds_of("01:30"), 90.0);
  EXPECT_EQ(seconds_of("01:00:05"), 3605.0);
  EXPECT_EQ(seconds_of("1-12"), 129600.0);
  EXPECT_EQ(seconds_of("1-00:01"), 86460.0);
}

TEST(ClusterTable, OptionsAskForResourcesAlone) {
  const auto parse = [](const std::string& option) {
    parse_study(one_method(), "s.toml", {"cluster.sbatch=[\"" + option + "\"]"});
  };
  for (const char* option : {"--dependency=afterok:1",
                             "--comment=x",
                             "--comm=x",
                             "-a 1-3",
                             "-d1",
                             "--output=x",
                             "--out=x",
                             "-o/etc/x",
                             "-Ho/etc/x",
                             "--wrap=x",
                             "--export=x",
                             "--qos=long --output=x",
                             "-C big -ox",
                             "qos=long",
                             "--",
                             "-",
                             "--qos long",
                             "-C big",
                             "-C=big",
                             "--clusters=big",
                             "-Mbig"}) {
    EXPECT_THROW(parse(option), InputError) << option;
  }
  for (const char* option : {"--qos=long", "--hold", "-H", "--exclusive", "--constraint=[a|b]",
                             "-Cbig", "--gres=gpu:1"}) {
    EXPECT_NO_THROW(parse(option)) << option;
  }
}

TEST(ClusterTable, ChangesNoKey) {
  TempFolder folder;
  const WorkFolder work(folder / "runs");
  const Plan one = make_plan(parse_study(one_method(), "s.toml"), work);
  const Plan other = make_plan(parse_study(one_method(), "s.toml", {"cluster.time=\"5\""}), work);
  for (std::size_t i = 0; i < one.nodes.size(); ++i) {
    EXPECT_EQ(one.nodes[i].key, other.nodes[i].key);
  }
}

}  // namespace
}  // namespace npdr::pipeline
