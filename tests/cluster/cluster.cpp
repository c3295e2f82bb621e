#include "tests/cluster/cluster.h"

#include <algorithm>
#include <sstream>

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

const std::string kScript = std::string(NPDR_SOURCE_DIR) + "/jobs/one-machine-cluster";

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Words and environment that the process was started with. Empty: it has ended meanwhile.
std::string started_with(const fs::path& process) try {
  return text_of(process / "cmdline") + '\0' + text_of(process / "environ");
} catch (const std::ios_base::failure&) {
  return {};
}

// All processes with all the texts in what they were started with.
std::vector<pid_t> processes_with(const std::vector<std::string>& texts) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string whole = started_with(entry.path());
    if (std::all_of(texts.begin(), texts.end(),
                    [&](const auto& text) { return whole.find(text) != std::string::npos; })) {
      found.push_back(std::stoi(name));
    }
  }
  return found;
}

pid_t parent_of(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string key; status >> key;) {
    pid_t parent = 0;
    if (key == "PPid:" && status >> parent) return parent;
  }
  return 0;
}

}  // namespace

Cluster::Cluster() {
  // munged wants the way to its socket open to all.
  fs::permissions(folder_.path(), static_cast<fs::perms>(0755));
  fs::create_directory(folder());
  const Outcome up =
      command({"up", "--cpus", "16", "--memory", "16000", "--while", std::to_string(getpid())});
  EXPECT_EQ(up.status, 0) << up.err;
}

Cluster::~Cluster() {
  if (::testing::Test::HasFailure()) {
    std::cerr << text_of(root() / "log/slurmctld.log") << text_of(root() / "log/jobs.txt");
  }
  command({"down"});
}

std::string Cluster::hindrance() {
  const TempFolder folder;
  fs::permissions(folder.path(), static_cast<fs::perms>(0755));
  const Outcome check = run(folder.path(), {kScript, "--root", folder / "cluster", "check"});
  return check.status == 0 ? "" : check.err;
}

Outcome Cluster::command(std::vector<std::string> words) const {
  words.insert(words.begin(), {kScript, "--root", root()});
  return run(folder_.path(), words);
}

Outcome Cluster::call(std::vector<std::string> words) const {
  const std::string path = std::getenv("PATH");
  words.insert(words.begin(), {"/usr/bin/env", "SLURM_CONF=" + (root() / "slurm.conf").string(),
                               "PATH=" NPDR_BINARY_DIR "/bin:" + path});
  return run(folder(), words, {folder_ / "stdout.txt", folder_ / "stderr.txt"});
}

std::string Cluster::submit(const std::string& script,
                            const std::vector<std::string>& options) const {
  std::ofstream(folder_ / "script.sh") << "#!/bin/bash\n" << script;
  std::vector<std::string> words = {"sbatch", "--parsable", "--mem=10", "--open-mode=append"};
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(folder_ / "script.sh");
  const Outcome outcome = call(words);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.out.substr(0, outcome.out.find_first_of(";\n"));
}

std::map<std::string, std::string> Cluster::states() const {
  std::map<std::string, std::string> found;
  const Outcome outcome = call({"squeue", "-h", "-r", "-t", "all", "-o", "%i %T"});
  for (const std::string& line : lines_of(outcome.out)) {
    const std::size_t space = line.find(' ');
    found[line.substr(0, space)] = line.substr(space + 1);
  }
  return found;
}

std::string Cluster::state(const std::string& task) const { return states()[task]; }

std::string Cluster::node_of(const std::string& task) const {
  const std::vector<std::string> lines =
      lines_of(call({"squeue", "-h", "-j", task, "-t", "running", "-o", "%N"}).out);
  return lines.empty() ? "" : lines.front();
}

void Cluster::wait_until(const std::string& what, const std::function<bool()>& done) const {
  // Rarely, as each question is a program or two.
  if (comes_true(done, std::chrono::minutes(4), std::chrono::milliseconds(50))) return;
  FAIL() << "waited in vain " << what << "\n"
         << call({"squeue", "-r", "-t", "all"}).out << call({"sinfo", "-N"}).out;
}

void Cluster::wait_for_state(const std::string& task, const std::string& state) const {
  wait_until("for " + task + " to be " + state, [&] { return this->state(task) == state; });
}

void Cluster::wait_until_idle() const {
  wait_until("for the last job", [&] {
    const Outcome queue = call({"squeue", "-h"});
    return queue.status == 0 && queue.out.empty();
  });
}

void Cluster::wait_for_file(const std::string& file) const {
  wait_until("for " + file, [&] { return fs::exists(folder() / file); });
}

void Cluster::wait_until_saved() const {
  const auto now = fs::file_time_type::clock::now();
  wait_until("for the controller to save its jobs", [&] {
    std::error_code missing;
    return fs::last_write_time(root() / "state/job_state", missing) > now;
  });
}

void Cluster::kill_shell_of(const std::string& task, int signal) const {
  const std::vector<std::string> ids =
      lines_of(call({"squeue", "-h", "-j", task, "-t", "running", "-o", "%A"}).out);
  ASSERT_EQ(ids.size(), 1u) << task << " doesn't run";
  const std::string zero(1, '\0');
  std::vector<pid_t> found = processes_with({root(), zero + "SLURM_JOB_ID=" + ids[0] + zero});
  const std::vector<pid_t> all = found;
  // All others of the task descend from the shell.
  std::erase_if(found, [&](pid_t process) {
    return std::ranges::find(all, parent_of(process)) != all.end();
  });
  ASSERT_EQ(found.size(), 1u);
  kill(found.front(), signal);
}

void Cluster::start_now(const std::string& task) const {
  wait_for_state(task, "PENDING");
  const Outcome update = call({"scontrol", "update", "JobId=" + task, "StartTime=now"});
  EXPECT_EQ(update.status, 0) << update.err;
}

std::vector<pid_t> Cluster::processes() const { return processes_with({root()}); }

void ClusterTest::SetUp() {
  const std::string hindrance = Cluster::hindrance();
  if (!hindrance.empty()) GTEST_SKIP() << hindrance;
  cluster_ = std::make_unique<Cluster>();
}

}  // namespace npdr::pipeline
