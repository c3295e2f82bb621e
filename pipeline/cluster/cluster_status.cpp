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
