#include "pipeline/cluster/cluster_status.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"
#include "core/text.h"
#include "pipeline/cluster/batch_task.h"
#include "pipeline/plan/completeness.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

std::filesystem::path ledger_of(const Plan& plan) { return jobs_folder(plan) / "submitted.jsonl"; }

std::filesystem::path lock_of(const Plan& plan) {
  make_folder(jobs_folder(plan));
  return jobs_folder(plan) / ".lock";
}

Json to_json(const LedgerEntry& entry) {
  return {{"job", entry.job},
          {"tag", entry.tag.text()},
          {"tasks", entry.tasks},
          {"script", entry.script.string()},
          {"logs", entry.logs.string()},
          {"stem", entry.stem},
          {"submitted", entry.submitted}};
}

LedgerEntry entry_of(const Json& json) {
  const auto tag = parse_tag(json.at("tag").get<std::string>());
  if (!tag) throw InputError("not a tag");
  return {json.at("job").get<std::string>(),          *tag,
          json.at("tasks").get<std::vector<Index>>(), json.at("script").get<std::string>(),
          json.at("logs").get<std::string>(),         json.at("stem").get<std::string>(),
          json.at("submitted").get<std::string>()};
}

using Ledger = std::vector<LedgerEntry>;

// The newest entry whose job makes a node, or helps to, and that passes a test; none: nullptr.
template <class Test>
const LedgerEntry* newest(const Ledger& ledger, const Node& node, bool is_helper,
                          const Test& test) {
  const auto is_its = [&](const std::string& digits) { return node.key.starts_with(digits); };
  const auto found = std::find_if(ledger.rbegin(), ledger.rend(), [&](const LedgerEntry& entry) {
    return entry.tag.is_helper == is_helper && std::ranges::any_of(entry.tag.keys, is_its) &&
           test(entry);
  });
  return found == ledger.rend() ? nullptr : &*found;
}

// The array's task that makes a shard.
Index task_of(const JobTag& tag, Index shard) {
  return shard / tag.shards_per_task - tag.first_task;
}

std::string task_id(const LedgerEntry& entry, Index index) {
  return entry.job + "_" + std::to_string(index);
}

// A task that is over without its result: why, and where to read more. Empty for one that never
// began because another one failed, or whose result has been removed since.
std::string failure_text(const LedgerEntry& entry, const std::string& id) {
  const std::filesystem::path log = entry.logs / fmt::format("{}-{}.log", entry.stem, id);
  const bool has_log = std::filesystem::exists(log);
  const std::optional<TaskEnd> end = has_log ? end_in_log(log) : std::nullopt;
  if (end && end->exit_status == 0) return "";
  std::string reason = end ? end->words : ended_state(id);
  if (!has_log) {
    if (reason.empty() || reason == "CANCELLED") return "";
    return fmt::format("job {}: {}, before it could write a log", id, reason);
  }
  if (reason.empty()) reason = "ended without a word: killed, or beyond its memory or time";
  return fmt::format("job {}: {}; log: {}", id, reason, log.string());
}

// Of tasks that aren't queued any more: of the last ones that made the node, or its missing shards,
// and of the helpers that were submitted last.
void add_failures(const Plan& plan, const Node& node, const Ledger& ledger,
                  const std::vector<QueuedTask>& queued, const std::set<Index>& shards_in_flight,
                  NodeJobs& jobs) {
  std::set<std::string> seen;
  const auto add = [&](const LedgerEntry& entry, const std::string& id,
                       std::vector<std::string>& failed) {
    if (!seen.insert(id).second) return;
    const std::string text = failure_text(entry, id);
    if (!text.empty()) failed.push_back(text);
  };
  const auto is_any = [](const LedgerEntry&) { return true; };
  if (node.stage == Stage::simulate) {
    for (const Index shard : missing_shards(plan, node)) {
      if (shards_in_flight.contains(shard)) continue;
      const LedgerEntry* const entry = newest(ledger, node, false, [&](const LedgerEntry& e) {
        return e.tag.shards_per_task > 0 && std::ranges::count(e.tasks, task_of(e.tag, shard)) > 0;
      });
      if (entry != nullptr) add(*entry, task_id(*entry, task_of(entry->tag, shard)), jobs.failed);
    }
  } else if (jobs.waiting.empty() && jobs.running.empty()) {
    const LedgerEntry* const entry = newest(ledger, node, false, is_any);
    if (entry != nullptr) add(*entry, entry->job, jobs.failed);
  }
  const LedgerEntry* const helpers = newest(ledger, node, true, is_any);
  for (const Index index : helpers != nullptr ? helpers->tasks : std::vector<Index>{}) {
    const std::string id = task_id(*helpers, index);
    if (std::ranges::find(queued, id, &QueuedTask::id) == queued.end()) {
      add(*helpers, id, jobs.failed_helpers);
    }
  }
}

std::string examples(const std::vector<QueuedTask>& tasks, bool with_node) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, tasks.size()); ++i) {
    text += fmt::format("{}{}", i > 0 ? ", " : "", tasks[i].id());
    if (with_node) text += " on " + tasks[i].node;
  }
  return tasks.size() > most ? text + ", ..." : text;
}

}  // namespace

std::filesystem::path jobs_folder(const Plan& plan) {
  return plan.work.study(plan.study.name) / "jobs";
}

SubmissionLock::SubmissionLock(const Plan& plan)
    : file_(lock_of(plan), O_RDWR | O_CREAT | O_NOFOLLOW) {
  const int error = errno;
  const std::filesystem::path path = lock_of(plan);
  if (!file_.is_open()) throw_file_error(path, "be written", error);
  constexpr int patience = 600;
  constexpr useconds_t pause = 100'000;  // [us]
  for (int i = 0; i < patience; ++i) {
    if (flock(file_.value(), LOCK_EX | LOCK_NB) == 0) return;
    if (errno != EWOULDBLOCK && errno != EINTR) return;  // there are no locks here
    usleep(pause);
  }
  throw Error(path.string() + ": somebody else submits this study; try again later");
}

// One write, as a rule: lines of two programs don't mix.
void append_to_ledger(const Plan& plan, const LedgerEntry& entry) {
  const std::filesystem::path path = ledger_of(plan);
  make_folder(path.parent_path());
  // Paths needn't be UTF-8; JSON must.
  const std::string line =
      to_json(entry).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const OpenFile file(path, O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW);
  if (!file.is_open() || !file.write(line) || fsync(file.value()) != 0) {
    throw Error(fmt::format("{}, so job {} isn't in the ledger",
                            file_error_text(path, "be written", errno), entry.job));
  }
}

std::vector<LedgerEntry> read_ledger(const Plan& plan) {
  std::vector<LedgerEntry> entries;
  std::ifstream file(ledger_of(plan));
  for (std::string line; std::getline(file, line);) {
    try {
      entries.push_back(entry_of(Json::parse(line)));
    } catch (const std::exception&) {
      continue;
    }
  }
  return entries;
}

std::vector<std::string> NodeJobs::details() const {
  std::vector<std::string> now;
  if (!running.empty()) {
    now.push_back(fmt::format("{} running ({})", running.size(), examples(running, true)));
  }
  if (!waiting.empty()) {
    now.push_back(fmt::format("{} queued ({}: {})", waiting.size(), examples(waiting, false),
                              waiting.front().reason));
  }
  if (num_helpers > 0 && !now.empty()) now.push_back(counted(num_helpers, "helper"));
  std::vector<std::string> parts = {join(now)};
  if (!failed.empty()) parts.push_back(failed.front());
  if (failed.size() > 1) parts.push_back(fmt::format("{} more failed", failed.size() - 1));
  if (!failed_helpers.empty()) {
    parts.push_back(counted(std::ssize(failed_helpers), "helper") + " failed, " +
                    failed_helpers.front());
  }
  return parts;
}

std::vector<std::optional<NodeJobs>> jobs_of_nodes(
    const Plan& plan, const std::optional<std::vector<QueuedTask>>& tasks) {
  std::vector<std::optional<NodeJobs>> found(plan.nodes.size());
  if (!tasks) return found;
  const Ledger ledger = read_ledger(plan);
  const std::vector<QueuedTask> ours = tasks_of(plan, *tasks);
  const std::vector<InFlight> flying = in_flight(plan, ours);
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    const Node& node = plan.nodes[i];
    if (is_complete(plan, node)) continue;
    NodeJobs jobs;
    for (const QueuedTask& task : ours) {
      if (task.is_running() && flying[i].helpers.contains(task.job)) ++jobs.num_helpers;
      if (std::ranges::find(flying[i].jobs, task.job) == flying[i].jobs.end()) continue;
      (task.is_running() ? jobs.running : jobs.waiting).push_back(task);
    }
    add_failures(plan, node, ledger, ours, flying[i].shards, jobs);
    if (!jobs.running.empty() || !jobs.waiting.empty() || !jobs.failed.empty() ||
        !jobs.failed_helpers.empty()) {
      found[i] = jobs;
    }
  }
  return found;
}

}  // namespace npdr::pipeline
