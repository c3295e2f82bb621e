#include "pipeline/cluster/doomed_jobs.h"

#include <algorithm>
#include <set>

#include "pipeline/cluster/job_tag.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/shards.h"

namespace npdr::pipeline {
namespace {

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
    const auto& needs = plan.nodes[i].needs;
    if (std::ranges::all_of(needs, [&](std::size_t n) { return will_come(plan, n, flights); })) {
      continue;
    }
    for (const std::string& job : jobs) {
      if (!begun.contains(job)) doomed.insert(job);
    }
  }
  return doomed;
}

}  // namespace

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
  std::vector<QueuedTask> left;
  std::ranges::copy_if(tasks, std::back_inserter(left), [&](const QueuedTask& task) {
    return std::ranges::find(jobs, task.job) == jobs.end();
  });
  return left;
}

}  // namespace npdr::pipeline
