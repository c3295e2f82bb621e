/// Runs the project's executables as a user would.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <source_location>
#include <string>
#include <vector>

#include "pipeline/store/artefact.h"
#include "tests/environment.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"
#include "tests/wait_for.h"

namespace npdr::pipeline {

struct Outcome {
  int status = 0;  ///< exit status, or 128 + the signal that ended it
  std::string out;
  std::string err;
  long peak_kib = 0;  ///< most memory that was resident at a time
};

/// Places that a program's output goes to, as seen from the folder that it runs in.
struct Streams {
  std::filesystem::path out = "stdout.txt";
  std::filesystem::path err = "stderr.txt";
};

/// A running program of the project, or with its whole path any other, in the folder `folder` and a
/// process group of its own. It ends when the test does.
class Program {
 public:
  Program(const std::filesystem::path& folder, const std::vector<std::string>& words,
          const Streams& streams = {})
      : out_(folder / streams.out), err_(folder / streams.err) {
    const std::filesystem::path path =
        std::filesystem::path(NPDR_BINARY_DIR) / "bin" / words.front();
    pid_ = fork();
    setpgid(pid_, 0);  // by both, as nobody knows who is first
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (chdir(folder.c_str()) != 0) _exit(127);
    redirect(out_, STDOUT_FILENO);
    redirect(err_, STDERR_FILENO);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    execv(path.c_str(), arguments.data());
    _exit(127);
  }

  pid_t pid() const { return pid_; }

  void send(int signal) const { kill(pid_, signal); }
  /// Sends as a terminal does Ctrl-C: to all that belongs to it.
  void send_to_group(int signal) const { kill(-pid_, signal); }

  bool has_ended() const { return npdr::has_ended(pid_); }
  /// Lets it go on for up to that long: a random instant, which nothing it does marks.
  bool ends_within(double seconds) const {
    return comes_true([&] { return has_ended(); }, std::chrono::duration<double>(seconds));
  }

  /// The processes that it started.
  std::vector<pid_t> children() const {
    const std::string pid = std::to_string(pid_);
    std::ifstream file("/proc/" + pid + "/task/" + pid + "/children");
    return {std::istream_iterator<pid_t>(file), {}};
  }

  Outcome wait() const {
    int status = 0;
    rusage usage = {};
    wait4(pid_, &status, 0, &usage);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), written_to(out_),
            written_to(err_), usage.ru_maxrss};
  }

 private:
  // Devices hold nothing, or more than there is memory.
  static std::string written_to(const std::filesystem::path& path) {
    return std::filesystem::is_regular_file(path) ? text_of(path) : "";
  }

  static void redirect(const std::filesystem::path& path, int descriptor) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(file, descriptor);
    close(file);
  }

  std::filesystem::path out_, err_;
  pid_t pid_ = -1;
};

inline Outcome run(const std::filesystem::path& folder, const std::vector<std::string>& words,
                   const Streams& streams = {}) {
  return Program(folder, words, streams).wait();
}

/// An outcome that must have this exit status, else the test fails `where` it was asked for.
inline Outcome with_status(int status, Outcome outcome,
                           const std::source_location& where = std::source_location::current()) {
  if (outcome.status != status) {
    ADD_FAILURE_AT(where.file_name(), static_cast<int>(where.line()))
        << "exit status " << outcome.status << ", must be " << status << "\n"
        << outcome.out << outcome.err;
  }
  return outcome;
}

/// All words in one list.
inline std::vector<std::string> joined(std::vector<std::string> words,
                                       const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// While it lives, programs that are started have this many threads.
struct OmpThreads : EnvironmentVariable {
  explicit OmpThreads(int count) : EnvironmentVariable("OMP_NUM_THREADS", std::to_string(count)) {}
};

/// While it lives, programs of this folder come before others of their names.
struct ProgramsOnPath : EnvironmentVariable {
  explicit ProgramsOnPath(const std::filesystem::path& folder = NPDR_BINARY_DIR "/bin")
      : EnvironmentVariable("PATH", folder.string() + ":" + std::getenv("PATH")) {}
};

/// Tests that call commands in a folder of their own.
class CommandTest : public ::testing::Test {
 protected:
  Outcome npdr(const std::vector<std::string>& words) const {
    return run(folder_.path(), joined({"npdr"}, words));
  }
  /// Of a command that must end with this exit status.
  Outcome npdr(int status, const std::vector<std::string>& words,
               const std::source_location& where = std::source_location::current()) const {
    return with_status(status, npdr(words), where);
  }

  TempFolder folder_;
};

/// A Python that has a package; "": none has.
inline std::string python_with(const std::string& package) {
  for (const char* name : {"python3", "/usr/bin/python3"}) {
    const std::string command = std::string(name) + " -c 'import " + package + "' 2>/dev/null";
    if (std::system(command.c_str()) == 0) return name;
  }
  return "";
}

/// A small pendulum study that takes a second: two methods, two rounds.
inline StudyText small_study() {
  return pendulum_study("small")
      .with("study", {"seeds = [1]"})
      .with("target", {"num_rollouts = 2"})
      .with("observation_noise", {"scale = 0.1"})
      .method("NPDR (MAF)", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 150",
                             "embedding = { kind = \"linear\", features = 8, downsample = 20, "
                             "principal_components = 12 }",
                             kSmallFlow, "training = { max_epochs = 30 }"})
      .method("NPDR (MoG)", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 150",
                             "embedding = { kind = \"bayessim\" }", kSmallMixture,
                             "training = { max_epochs = 30 }"})
      .with("evaluate", {"num_samples = 50"});
}

/// Tests that call commands beside the small study.
class SmallStudyTest : public CommandTest {
 protected:
  SmallStudyTest() { folder_.file("small.toml", small_study()); }
};

/// A small mini golf study that takes seconds.
inline StudyText small_minigolf_study() {
  return minigolf_study("small")
      .with("observation_noise", {"scale = 0.01"})
      .method("NPDR (MAF)", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 100",
                             "embedding = { kind = \"linear\", features = 8, downsample = 20 }",
                             kSmallFlow, "training = { max_epochs = 20 }"})
      .with("evaluate",
            {"num_samples = 30", "metrics = [\"dtw\", \"rmse\", \"final_error\", \"goal\"]"})
      .add("reference", {"name = \"heavy\"", "parameters = { ball_mass = 0.007 }"})
      .with("limits", {"max_failed_fraction = 0.5"});
}

/// Names, below the folder, of all files that end so; also while programs work in it.
inline std::set<std::string> files_ending(const std::filesystem::path& folder,
                                          const std::string& end) {
  std::set<std::string> found;
  std::error_code gone;
  std::filesystem::recursive_directory_iterator entry(folder, gone);
  for (; entry != std::filesystem::recursive_directory_iterator(); entry.increment(gone)) {
    const std::string name = entry->path().lexically_relative(folder);
    if (name.ends_with(end)) found.insert(name);
  }
  return found;
}

/// Files of unfinished work.
inline std::set<std::string> temporaries(const std::filesystem::path& folder) {
  return files_ending(folder, ".tmp");
}

/// Tells whether the program, or what it has started, gets to make `count` files below the folder
/// at the same time. Once it does, it listens to requests to stop.
inline bool begins_to_make(const Program& program, const std::filesystem::path& folder,
                           std::ptrdiff_t count = 1) {
  const auto num_in_the_making = [&] {
    std::vector<pid_t> processes = program.children();
    processes.push_back(program.pid());
    return std::ranges::count_if(temporaries(folder), [&](const std::string& name) {
      return std::ranges::any_of(processes, [&](pid_t process) {
        return name.find("." + std::to_string(process) + ".") != std::string::npos;
      });
    });
  };
  comes_true([&] { return program.has_ended() || num_in_the_making() >= count; });
  return !program.has_ended();
}

/// Digests of all artefacts of a work folder, by their place in the study's readable folder.
inline std::map<std::string, std::string> digests(const std::filesystem::path& study_folder) {
  std::map<std::string, std::string> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(study_folder)) {
    if (entry.path().extension() != ".h5") continue;
    found[entry.path().lexically_relative(study_folder)] = content_digest(entry.path());
  }
  return found;
}

}  // namespace npdr::pipeline
