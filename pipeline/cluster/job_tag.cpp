#include "pipeline/cluster/job_tag.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/text.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

constexpr std::size_t kKeyDigits = 16;  // enough for all artefacts of all studies
constexpr std::size_t kWorkDigits = 12;
constexpr std::string_view kMaker = "npdr", kHelper = "npdr-help";

// Digits that tell this work folder from others, the same from every machine that calls it the
// same.
std::string work_digits(const WorkFolder& work) {
  Hasher hasher;
  hasher.add(std::filesystem::weakly_canonical(std::filesystem::absolute(work.root())).string());
  return hasher.hex().substr(0, kWorkDigits);
}

// visit(task, tag, node) for each node of the plan that a task makes, or helps to.
template <class Visit>
void for_each_node(const Plan& plan, const std::vector<QueuedTask>& tasks, const Visit& visit) {
  std::map<std::string, std::size_t> nodes;  // by the digits of their keys
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    nodes[plan.nodes[i].key.substr(0, kKeyDigits)] = i;
  }
  const std::string work = work_digits(plan.work);
  for (const QueuedTask& task : tasks) {
    const std::optional<JobTag> tag = parse_tag(task.comment);
    if (!tag || tag->work != work) continue;
    for (const std::string& key : tag->keys) {
      const auto node = nodes.find(key);
      if (node != nodes.end()) visit(task, *tag, node->second);
    }
  }
}

// A job that isn't an array makes all that is missing.
void add_shards(const JobTag& tag, const QueuedTask& task, Index num_shards, InFlight& found) {
  Index first = 0, end = num_shards;
  if (tag.shards_per_task > 0 && task.index) {
    found.shards_per_task = tag.shards_per_task;
    first = (tag.first_task + *task.index) * tag.shards_per_task;
    end = std::min(first + tag.shards_per_task, num_shards);
  }
  for (Index shard = first; shard < end; ++shard) found.shards.insert(shard);
}

using Flights = std::vector<InFlight>;

bool will_come(const Plan& plan, std::size_t i, const Flights& flights) {
  const Node& node = plan.nodes[i];
  if (is_complete(plan, node)) return true;
  if (node.stage != Stage::simulate) return flights[i].is_made();
  return std::ranges::all_of(missing_shards(plan, node),
                             [&](Index shard) { return flights[i].shards.contains(shard); });
}

// Those whose own needs don't come; what waits for them is found when they are left out.
std::set<std::string> doomed_now(const Plan& plan, const std::vector<QueuedTask>& tasks) {
  std::set<std::string> begun;
  for (const QueuedTask& task : tasks) {
    if (task.is_running()) begun.insert(task.job);
  }
  const Flights flights = in_flight(plan, tasks);
  std::set<std::string> doomed;
  for (std::size_t i = 0; i < plan.nodes.size(); ++i) {
    std::set<std::string> jobs = flights[i].helpers;
    jobs.insert(flights[i].jobs.begin(), flights[i].jobs.end());
    if (jobs.empty() || is_complete(plan, plan.nodes[i])) continue;
    const auto comes = [&](std::size_t need) { return will_come(plan, need, flights); };
    if (std::ranges::all_of(plan.nodes[i].needs, comes)) continue;
    std::ranges::set_difference(jobs, begun, std::inserter(doomed, doomed.end()));
  }
  return doomed;
}

}  // namespace

std::string JobTag::text() const {
  return fmt::format("{}:{}:{}:{}:{}", is_helper ? kHelper : kMaker, work, fmt::join(keys, ","),
                     shards_per_task, first_task);
}

JobTag tag_of(const Plan& plan, const Job& job) {
  JobTag tag{work_digits(plan.work), {}, job.shards_per_task, job.first_task, job.is_helper()};
  for (const std::size_t i : job.nodes) {
    // A job that makes something of a simulation only joins its shards.
    const bool is_joined = plan.nodes[i].stage == Stage::simulate && !job.is_array();
    if (is_joined && job.nodes.size() > 1) continue;
    tag.keys.push_back(plan.nodes[i].key.substr(0, kKeyDigits));
  }
  return tag;
}

std::optional<JobTag> parse_tag(const std::string& comment) {
  const std::vector<std::string> parts = split(comment, ':');
  constexpr std::size_t num_parts = 5;
  if (parts.size() != num_parts || (parts[0] != kMaker && parts[0] != kHelper)) {
    return std::nullopt;
  }
  const auto shards_per_task = parse_count(parts[3]), first_task = parse_count(parts[4]);
  if (!shards_per_task || !first_task) return std::nullopt;
  return JobTag{parts[1], split(parts[2], ','), *shards_per_task, *first_task, parts[0] == kHelper};
}

std::vector<InFlight> in_flight(const Plan& plan, const std::vector<QueuedTask>& tasks) {
  std::vector<InFlight> found(plan.nodes.size());
  for_each_node(plan, tasks, [&](const QueuedTask& task, const JobTag& tag, std::size_t node) {
    InFlight& its = found[node];
    if (tag.is_helper) {
      its.helpers.insert(task.job);
      return;
    }
    if (std::ranges::find(its.jobs, task.job) == its.jobs.end()) its.jobs.push_back(task.job);
    const Node& made = plan.nodes[node];
    if (made.stage == Stage::simulate) add_shards(tag, task, num_shards(plan, made), its);
  });
  return found;
}

std::vector<QueuedTask> tasks_of(const Plan& plan, const std::vector<QueuedTask>& tasks) {
  std::vector<QueuedTask> ours;
  const QueuedTask* last = nullptr;
  for_each_node(plan, tasks, [&](const QueuedTask& task, const JobTag&, std::size_t) {
    if (std::exchange(last, &task) != &task) ours.push_back(task);
  });
  return ours;
}

std::vector<std::string> doomed_jobs(const Plan& plan, const std::vector<QueuedTask>& tasks) {
  std::vector<std::string> all;
  std::vector<QueuedTask> left = tasks;
  for (std::set<std::string> doomed = doomed_now(plan, left); !doomed.empty();
       doomed = doomed_now(plan, left)) {
    all.insert(all.end(), doomed.begin(), doomed.end());
    left = without_jobs(left, {doomed.begin(), doomed.end()});
  }
  return all;
}

std::vector<QueuedTask> without_jobs(const std::vector<QueuedTask>& tasks,
                                     const std::vector<std::string>& jobs) {
  std::vector<QueuedTask> left = tasks;
  std::erase_if(left,
                [&](const QueuedTask& task) { return std::ranges::count(jobs, task.job) > 0; });
  return left;
}

}  // namespace npdr::pipeline
