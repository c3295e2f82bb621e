#include "pipeline/cluster/job.h"

#include <algorithm>

#include "pipeline/plan/completeness.h"
#include "pipeline/run/scheduler.h"

namespace npdr::pipeline {
namespace {

// Limit of what one job makes: all of it stands in its comment, for which Slurm has 1024 bytes.
constexpr std::size_t kMostNodes = 48;

bool is_preparation(const Node& node) {
  return traits_of(node.stage).resources == &ClusterConfig::prepare;
}

template <class T>
void add_once(std::vector<T>& list, const T& value) {
  if (std::ranges::find(list, value) == list.end()) list.push_back(value);
}

// Makes the list of jobs, node by node in the order of the plan.
class JobMaker {
 public:
  explicit JobMaker(const JobsInput& input)
      : input_(input), jobs_of_(input.plan.nodes.size()), is_missing_(input.plan.nodes.size()) {
    for (const Node* node : missing_nodes(input.plan, input.until)) {
      is_missing_[index_of(*node)] = true;
    }
  }

  std::vector<Job> make() {
    for (std::size_t i = 0; i < input_.plan.nodes.size(); ++i) {
      if (is_missing_[i]) add(i);
    }
    return std::move(jobs_);
  }

 private:
  std::size_t index_of(const Node& node) const {
    return static_cast<std::size_t>(&node - input_.plan.nodes.data());
  }
  const Node& node(std::size_t i) const { return input_.plan.nodes[i]; }

  void add(std::size_t i) {
    if (node(i).stage == Stage::simulate) {
      add_simulation(i);
    } else if (input_.in_flight[i].is_made()) {
      add_helpers(i);  // others wait for it
    } else if (is_preparation(node(i))) {
      add_preparation(i);
    } else {
      add_job(i);
      add_helpers(i);
    }
  }

  // Makes a node's job wait for the jobs of what the node needs. An array that the cluster has may
  // have lost tasks: then it never succeeds, but the job that joins its shards makes what is
  // missing.
  void wait_for_needs(std::size_t i, Job& job) const {
    for (const std::size_t need : node(i).needs) {
      if (!is_missing_[need]) continue;
      for (const std::size_t other : jobs_of_[need]) add_once(job.needs, other);
      auto& waits = node(need).stage == Stage::simulate ? job.after_any : job.after_ok;
      for (const std::string& id : input_.in_flight[need].jobs) add_once(waits, id);
    }
  }

  // Without the jobs that others of its needs wait for anyway.
  std::size_t append(Job job) {
    std::set<std::size_t> implied;
    for (const std::size_t need : job.needs) implied.merge(std::set(before_[need]));
    std::erase_if(job.needs, [&](std::size_t need) { return implied.contains(need); });
    implied.insert(job.needs.begin(), job.needs.end());
    before_.push_back(std::move(implied));
    jobs_.push_back(std::move(job));
    return jobs_.size() - 1;
  }

  bool has_room(std::size_t job) const {
    return !jobs_[job].is_array() && jobs_[job].nodes.size() < kMostNodes;
  }

  // To the job that makes what it needs, when that is a single one, else to one for all that needs
  // nothing.
  void add_preparation(std::size_t i) {
    Job waiting;
    wait_for_needs(i, waiting);
    const bool waits = !waiting.after_ok.empty() || !waiting.after_any.empty();
    std::optional<std::size_t> job;
    if (!waits && waiting.needs.size() == 1 && has_room(waiting.needs.front())) {
      job = waiting.needs.front();
    } else if (!waits && waiting.needs.empty()) {
      if (!first_ || !has_room(*first_)) first_ = append({});
      job = first_;
    }
    if (!job) job = append(std::move(waiting));
    jobs_[*job].nodes.push_back(i);
    jobs_of_[i] = {*job};
  }

  void add_simulation(std::size_t i) {
    const auto& in_flight = input_.in_flight[i];
    // As those that run: other packs would overlap with theirs.
    const bool is_packed = in_flight.shards_per_task > 0;
    const Index pack = is_packed ? in_flight.shards_per_task : input_.shards_per_task[i];
    std::set<Index> tasks;
    for (const Index shard : missing_shards(input_.plan, node(i))) {
      if (!in_flight.shards.contains(shard)) tasks.insert(shard / pack);
    }
    Job array;
    array.nodes = {i};
    wait_for_needs(i, array);
    if (tasks.empty() && !in_flight.is_made()) jobs_of_[i] = {append(array)};  // only to be joined
    array.shards_per_task = pack;
    Index first = 0;
    for (auto task = tasks.begin(); task != tasks.end();) {
      if (array.tasks.empty()) first = *task;
      array.tasks.push_back(*task - first);
      ++task;
      const bool is_full = task == tasks.end() || *task - first >= input_.max_array_size;
      if (!is_full) continue;
      array.first_task = first;
      jobs_of_[i].push_back(append(array));
      array.tasks.clear();
    }
  }

  // Whether a job that `job` waits for joins the shards of a simulation.
  bool joins_before(const Job& job, std::size_t simulation) const {
    const auto joins = [&](std::size_t other) {
      return !jobs_[other].is_array() &&
             std::ranges::find(jobs_[other].nodes, simulation) != jobs_[other].nodes.end();
    };
    return std::ranges::any_of(job.needs, [&](std::size_t need) {
      return joins(need) || std::ranges::any_of(before_[need], joins);
    });
  }

  void add_job(std::size_t i) {
    Job job;
    wait_for_needs(i, job);
    for (const std::size_t need : node(i).needs) {
      const bool is_simulation = is_missing_[need] && node(need).stage == Stage::simulate;
      if (is_simulation && !joins_before(job, need)) job.nodes.push_back(need);
    }
    job.nodes.push_back(i);
    jobs_of_[i] = {append(std::move(job))};
  }

  // What the refinement waits for is there when it has begun. Should it never begin, because that
  // has failed, helpers have to go, too.
  void add_helpers(std::size_t i) {
    const Index wanted = std::min(input_.plan.study.cluster.refine_tasks, input_.max_array_size);
    if (wanted == 0 || !is_refinement(input_.plan, node(i)) || !input_.in_flight[i].helpers.empty())
      return;
    Job helpers;
    helpers.nodes = {i};
    wait_for_needs(i, helpers);
    helpers.helps = jobs_of_[i];
    helpers.helps_queued = input_.in_flight[i].jobs;
    for (Index task = 0; task < wanted; ++task) helpers.tasks.push_back(task);
    append(std::move(helpers));
  }

  const JobsInput& input_;
  std::vector<Job> jobs_;
  std::vector<std::vector<std::size_t>> jobs_of_;  ///< of each node, those that make it
  std::vector<bool> is_missing_;
  std::vector<std::set<std::size_t>> before_;  ///< of each job, all that it waits for
  std::optional<std::size_t> first_;           ///< the job of all that needs nothing
};

}  // namespace

std::vector<Job> make_jobs(const JobsInput& input) { return JobMaker(input).make(); }

Stage stage_of(const Plan& plan, const Job& job) {
  if (job.is_helper()) return Stage::simulate;
  Stage stage = plan.nodes[job.nodes.front()].stage;
  for (const std::size_t i : job.nodes) {
    if (!is_preparation(plan.nodes[i])) stage = plan.nodes[i].stage;
  }
  return stage;
}

std::string label_of(const Plan& plan, const Job& job) {
  if (job.is_helper()) return "help " + plan.nodes[job.nodes.front()].label();
  const Stage stage = stage_of(plan, job);
  for (const std::size_t i : job.nodes) {
    const Node& node = plan.nodes[i];
    if (node.stage == stage && !is_preparation(node)) return node.label();
  }
  return job.nodes.size() == 1 ? plan.nodes[job.nodes.front()].label() : kPrepareLabel;
}

}  // namespace npdr::pipeline
