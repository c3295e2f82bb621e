#include "pipeline/cluster/slurm.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/shell_call.h"
#include "core/shell_text.h"
#include "core/temporary_folder.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

constexpr double kPatience = 60.0;  // [s] for one answer
constexpr int kNotFound = 127;      // what a shell says of a command that isn't there

struct Answer {
  CallResult result;
  std::string text;  // all of its standard output
};

// Variables that change what Slurm's programs do or print, or that tell a job about itself: a
// submission from inside of a job, or under somebody's settings, must be like any other.
std::vector<std::string> ignored_variables() {
  std::vector<std::string> names;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    const std::string name = text.substr(0, text.find('='));
    const bool is_slurms = name.starts_with("SLURM_") || name.starts_with("SBATCH_") ||
                           name.starts_with("SQUEUE_") || name.starts_with("SCANCEL_");
    if (is_slurms && name != "SLURM_CONF" && name != "SLURM_CLUSTERS") names.push_back(name);
  }
  return names;
}

// A file of its own takes what is printed: a queue may hold thousands of lines. Without the
// variable that is set, squeue cuts long lists of indices.
Answer ask(const std::vector<std::string>& words) {
  const TemporaryFolder folder("npdr-slurm", "Slurm's answers are left there");
  const std::filesystem::path output = folder.path() / "answer";
  std::vector<std::string> command = {"env"};
  for (const std::string& name : ignored_variables()) command.insert(command.end(), {"-u", name});
  command.push_back("SLURM_BITSTR_LEN=0");
  command.insert(command.end(), words.begin(), words.end());
  Answer answer;
  answer.result = run_shell({shell_text(command) + " > " + shell_word(output),
                             std::filesystem::current_path(),
                             {},
                             kPatience});
  // It isn't there where no shell could be started, which the result tells.
  if (std::filesystem::exists(output)) answer.text = read_text_file(output);
  return answer;
}

std::string ask_or_fail(const std::vector<std::string>& words) {
  const Answer answer = ask(words);
  if (answer.result.succeeded()) return answer.text;
  if (answer.result.exit_status == kNotFound) {
    throw Error(fmt::format(
        "there is no Slurm here: '{}' isn't on the PATH; docs/cluster.md says how other batch "
        "systems run a study",
        words.front()));
  }
  throw Error(fmt::format("{} failed: {}\n{}", words.front(), answer.result.words(kPatience),
                          answer.result.output));
}

}  // namespace

std::vector<std::string> sbatch_command(const Submission& submission) {
  std::vector<std::string> words = {"sbatch", "--parsable"};
  if (!submission.array.empty()) words.push_back("--array=" + submission.array);
  using Ids = const std::vector<std::string>*;
  std::vector<std::string> dependencies;
  for (const auto& [kind, ids] : {std::pair<const char*, Ids>{"afterok", &submission.after_ok},
                                  {"afterany", &submission.after_any},
                                  {"after", &submission.after}}) {
    if (!ids->empty()) dependencies.push_back(fmt::format("{}:{}", kind, join(*ids, ":")));
  }
  if (!dependencies.empty()) words.push_back("--dependency=" + join(dependencies, ","));
  words.insert(words.end(), submission.options.begin(), submission.options.end());
  words.push_back(submission.script);
  return words;
}

std::string submit_to_slurm(const Submission& submission) {
  const std::string text = ask_or_fail(sbatch_command(submission));
  // "17", or "17;cluster" where there are several.
  const std::string id = text.substr(0, text.find_first_of(";\n"));
  if (!parse_count(id)) {
    throw Error(fmt::format("sbatch answered '{}', must be the id of a job", text));
  }
  return id;
}

// Not by --array, which makes a line of each task: Slurm 22.05 leaves out the last one of some
// arrays then.
std::vector<QueuedTask> queued_tasks() {
  const std::string answer = ask_or_fail(
      {"squeue", "--noheader", fmt::format("--user={}", getuid()), "--format=%F|%K|%T|%r|%N|%k"});
  std::vector<QueuedTask> tasks;
  for (const std::string& line : split(answer, '\n')) {
    for (QueuedTask& task : parse_queued_tasks(line)) {
      if (task.state != "COMPLETING") tasks.push_back(std::move(task));
    }
  }
  return tasks;
}

std::vector<QueuedTask> parse_queued_tasks(const std::string& line) {
  const std::vector<std::string> fields = split(line + '|', '|');  // the last may be empty
  constexpr std::ptrdiff_t before_comment = 5;
  if (std::ssize(fields) <= before_comment || !parse_count(fields[0])) return {};
  const QueuedTask job{fields[0], std::nullopt,
                       fields[2], fields[3],
                       fields[4], join({fields.begin() + before_comment, fields.end()}, "|")};
  std::vector<QueuedTask> tasks;
  for (const Index index : parse_indices(fields[1])) {
    tasks.push_back(job);
    tasks.back().index = index;
  }
  return tasks.empty() ? std::vector{job} : tasks;
}

std::vector<Index> parse_indices(const std::string& text) {
  std::vector<Index> indices;
  for (const std::string& range : split(text.substr(0, text.find('%')), ',')) {
    const std::size_t dash = range.find('-'), colon = range.find(':');
    const auto first = parse_count(range.substr(0, dash));
    const auto last =
        dash == std::string::npos ? first : parse_count(range.substr(dash + 1, colon - dash - 1));
    const auto step = colon == std::string::npos ? Index{1} : parse_count(range.substr(colon + 1));
    if (!first || !last || !step || *step < 1) return {};
    for (Index index = *first; index <= *last; index += *step) indices.push_back(index);
  }
  return indices;
}

Index max_array_size() {
  for (const std::string& line : split(ask_or_fail({"scontrol", "show", "config"}), '\n')) {
    if (!line.starts_with("MaxArraySize")) continue;
    const std::size_t value = line.find_first_of("0123456789");
    if (value == std::string::npos) break;
    if (const auto size = parse_count(line.substr(value)); size && *size > 0) return *size;
  }
  throw Error("'scontrol show config' doesn't say MaxArraySize; set cluster.max_array_size");
}

void cancel_in_slurm(const std::vector<std::string>& ids) {
  constexpr std::size_t at_once = 200;
  for (std::size_t i = 0; i < ids.size(); i += at_once) {
    std::vector<std::string> words = {"scancel"};
    std::ranges::copy(std::span(ids).subspan(i, std::min(at_once, ids.size() - i)),
                      std::back_inserter(words));
    ask_or_fail(words);
  }
}

std::vector<std::string> requeue_command(const std::string& id) {
  return {"scontrol", "requeue", id};
}

std::string ended_state(const std::string& id) {
  const Answer answer = ask({"scontrol", "--oneliner", "show", "job", id});
  if (!answer.result.succeeded()) return "";
  constexpr std::string_view key = "JobState=";
  const std::size_t at = answer.text.find(key);
  if (at == std::string::npos) return "";
  const std::string rest = answer.text.substr(at + key.size());
  return rest.substr(0, rest.find_first_of(" \n"));
}

}  // namespace npdr::pipeline
