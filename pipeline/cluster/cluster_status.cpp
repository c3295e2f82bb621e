#include "pipeline/cluster/cluster_status.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/text.h"
#include "pipeline/cluster/job_script.h"
#include "pipeline/cluster/task_log.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/shards.h"

namespace npdr::pipeline {
namespace {

// The newest entry that makes a node, or a shard of it.
class Ledger {
 public:
  explicit Ledger(const Plan& plan) : entries_(read_ledger(plan)) {}

  const LedgerEntry* of_node(const std::string& key) const {
    return newest([&](const LedgerEntry& entry) { return makes(entry, key); });
  }

  const LedgerEntry* of_helpers(const std::string& key) const {
    return newest(
        [&](const LedgerEntry& entry) { return entry.tag.is_helper && is_about(entry, key); });
  }

  // The task, with its index in the array.
  std::pair<const LedgerEntry*, Index> of_shard(const std::string& key, Index shard) const {
    Index index = 0;
    const LedgerEntry* found = newest([&](const LedgerEntry& entry) {
      if (!makes(entry, key) || entry.tag.shards_per_task == 0) return false;
      index = shard / entry.tag.shards_per_task - entry.tag.first_task;
      return std::ranges::find(entry.tasks, index) != entry.tasks.end();
    });
    return {found, index};
  }

 private:
  static bool makes(const LedgerEntry& entry, const std::string& key) {
    return !entry.tag.is_helper && is_about(entry, key);
  }

  static bool is_about(const LedgerEntry& entry, const std::string& key) {
    return std::ranges::any_of(entry.tag.keys,
                               [&](const std::string& digits) { return key.starts_with(digits); });
  }

  template <class Test>
  const LedgerEntry* newest(const Test& test) const {
    const auto found = std::find_if(entries_.rbegin(), entries_.rend(), test);
    return found == entries_.rend() ? nullptr : &*found;
  }

  std::vector<LedgerEntry> entries_;
};

// A task that is over without its result: why, and where to read more. Empty for one that never
// began because another one failed, or whose result has been removed since.
std::string failure_text(const LedgerEntry& entry, const std::string& id) {
  const std::filesystem::path log = log_of_task(entry.logs, entry.stem, id);
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

void add_failures(const Plan& plan, const Node& node, const Ledger& ledger,
                  const std::set<Index>& shards_in_flight, NodeJobs& jobs) {
  std::set<std::string> seen;
  const auto add = [&](const LedgerEntry* entry, const std::string& id) {
    if (entry == nullptr || !seen.insert(id).second) return;
    const std::string text = failure_text(*entry, id);
    if (!text.empty()) jobs.failed.push_back(text);
  };
  if (node.stage != Stage::simulate) {
    const LedgerEntry* entry = ledger.of_node(node.key);
    if (entry != nullptr && jobs.waiting.empty() && jobs.running.empty()) add(entry, entry->job);
    return;
  }
  for (const Index shard : missing_shards(plan, node)) {
    if (shards_in_flight.contains(shard)) continue;
    const auto [entry, index] = ledger.of_shard(node.key, shard);
    if (entry != nullptr) add(entry, entry->job + "_" + std::to_string(index));
  }
}

// Of the helpers that were submitted last.
void add_failed_helpers(const Ledger& ledger, const Node& node,
                        const std::vector<QueuedTask>& queued, NodeJobs& jobs) {
  const LedgerEntry* entry = ledger.of_helpers(node.key);
  if (entry == nullptr) return;
  for (const Index index : entry->tasks) {
    const std::string id = entry->job + "_" + std::to_string(index);
    if (std::ranges::find(queued, id, &QueuedTask::id) != queued.end()) continue;
    const std::string text = failure_text(*entry, id);
    if (!text.empty()) jobs.failed_helpers.push_back(text);
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
  const Ledger ledger(plan);
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
    add_failures(plan, node, ledger, flying[i].shards, jobs);
    add_failed_helpers(ledger, node, ours, jobs);
    if (!jobs.running.empty() || !jobs.waiting.empty() || !jobs.failed.empty() ||
        !jobs.failed_helpers.empty()) {
      found[i] = jobs;
    }
  }
  return found;
}

}  // namespace npdr::pipeline
