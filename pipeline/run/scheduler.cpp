#include "pipeline/run/scheduler.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <set>

#include "core/atomic_file.h"
#include "core/finding.h"
#include "core/stop_request.h"
#include "pipeline/plan/completeness.h"

namespace npdr::pipeline {
namespace {

// Unlike fmt::print(), doesn't throw: a terminal that was closed or a full disk end no run.
void print(const std::string& text) { std::fputs(text.c_str(), stderr); }

// Where nothing is missing, nobody comes by who would remove what killed programs left behind.
void remove_stale_temporaries_of(const Plan& plan) {
  const std::filesystem::path readable = plan.work.study(plan.study.name);
  std::set<std::filesystem::path> folders = {readable};
  for (const Node& node : plan.nodes) {
    folders.insert(node.path.parent_path());
    if (node.stage == Stage::simulate) folders.insert(plan.work.shard(node.key, {}).parent_path());
  }
  std::error_code error;
  std::filesystem::recursive_directory_iterator entry(readable, error);
  for (const auto end = decltype(entry)(); !error && entry != end; entry.increment(error)) {
    if (entry->is_directory(error)) folders.insert(entry->path());
  }
  for (const std::filesystem::path& folder : folders) remove_stale_temporaries(folder);
}

// With the program of a stage.
std::vector<std::string> command_about(const Plan& plan, Stage program, const Node& node) {
  std::vector<std::string> command = {executable_folder() / traits_of(program).program};
  append(command, plan.words);
  command.insert(command.end(), {"--artefact", node.key});
  return command;
}

// What a job's progress counts, where it is worth a word.
std::string unit_of(const Plan& plan, const Node& node) {
  if (node.stage == Stage::simulate) return " simulations";
  if (node.stage != Stage::infer) return "";
  const MethodConfig& method = plan.study.method(node.uses.front().method);
  const bool trains = family_of(method) == inference::AlgorithmFamily::network;
  return trains ? " epochs" : " simulations";
}

// The policy of an earlier iteration collects what the next one infers from.
bool comes_until(const Plan& plan, const Node& node, Stage until) {
  if (node.stage <= until) return true;
  if (node.stage != Stage::policy || until < Stage::infer) return false;
  return std::ranges::any_of(plan.nodes, [&](const Node& other) {
    return other.stage == Stage::target && std::ranges::any_of(other.needs, [&](std::size_t need) {
             return &plan.nodes[need] == &node;
           });
  });
}

}  // namespace

std::vector<std::string> stage_command(const Plan& plan, const Node& node) {
  return command_about(plan, node.stage, node);
}

std::vector<std::string> helper_command(const Plan& plan, const Node& node, const Helper& helper) {
  std::vector<std::string> command = command_about(plan, Stage::simulate, node);
  command.insert(command.end(), {"--helper", fmt::format("{}/{}", helper.number, helper.count)});
  return command;
}

std::vector<const Node*> missing_nodes(const Plan& plan, std::optional<Stage> until) {
  std::vector<const Node*> missing;
  std::vector<bool> is_reachable;  // complete, or made before `until` ends
  for (const Node& node : plan.nodes) {
    const bool is_there = is_complete(plan, node);
    const auto is_reached = [&](std::size_t need) { return is_reachable[need]; };
    const bool can_be_made =
        (!until || comes_until(plan, node, *until)) && std::ranges::all_of(node.needs, is_reached);
    is_reachable.push_back(is_there || can_be_made);
    if (!is_there && can_be_made) missing.push_back(&node);
  }
  return missing;
}

std::vector<const Node*> missing_nodes(const Plan& plan, const SchedulerConfig& config) {
  std::vector<const Node*> missing = missing_nodes(plan, config.until);
  if (config.artefacts.empty()) return missing;
  std::erase_if(missing, [&](const Node* node) {
    return std::ranges::count(config.artefacts, node->key) == 0;
  });
  for (const Node* node : missing) {
    for (const std::size_t need : node->needs) {
      const Node& needed = plan.nodes[need];
      if (std::ranges::count(missing, &needed) == 0) require_input(plan, *node, needed);
    }
  }
  return missing;
}

Scheduler::Scheduler(const Plan& plan, SchedulerConfig config)
    : plan_(plan),
      config_(std::move(config)),
      states_(plan.nodes.size(), State::done),
      free_slots_(config_.num_jobs),
      costs_(plan),
      start_(Clock::now()),
      shown_(start_) {
  for (const Node* node : missing_nodes(plan, config_)) {
    states_[static_cast<std::size_t>(node - plan.nodes.data())] = State::waiting;
    ++num_missing_;
  }
  for (const Node& node : plan.nodes) {
    if (is_complete(plan, node)) settle(plan, node);
  }
}

ExitStatus Scheduler::run() {
  watch_for_stop_requests();
  for (;;) {
    if (stop_requested() && !passed_on_) pass_on_stop_request();
    if (!stopping_) start_ready_jobs();
    if (jobs_.empty()) break;
    wait_for_news();
    collect_ended_jobs();
    show_progress(false);
  }
  lines_.clear();
  remove_stale_temporaries_of(plan_);
  if (num_missing_ > 0 && status_ == ExitStatus::done) show_progress(true);
  if (stopping_ && num_made_ < num_missing_ && status_ == ExitStatus::done) {
    status_ = ExitStatus::checkpointed;
  }
  return status_;
}

bool Scheduler::is_ready(std::size_t node) const {
  const auto is_done = [&](std::size_t need) { return states_[need] == State::done; };
  return states_[node] == State::waiting && std::ranges::all_of(plan_.nodes[node].needs, is_done);
}

void Scheduler::start_ready_jobs() {
  std::vector<std::size_t> ready;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (is_ready(i)) ready.push_back(i);
  }
  for (std::size_t r = 0; r < ready.size() && free_slots_ > 0; ++r) {
    const int share = std::max(1, free_slots_ / static_cast<int>(ready.size() - r));
    const Node& node = plan_.nodes[ready[r]];
    const bool uses_threads = traits_of(node.stage).uses_threads || simulates(plan_, node);
    start(ready[r], uses_threads ? share : 1);
  }
}

void Scheduler::start(std::size_t index, int threads) {
  const Node& node = plan_.nodes[index];
  JobLog log{log_of(plan_, node)};
  std::error_code none;
  const auto size = std::filesystem::file_size(log.path, none);
  if (!none) log.begin = size;
  jobs_.emplace_back(index, threads, stage_command(plan_, node), std::move(log));
  states_[index] = State::running;
  free_slots_ -= threads;
}

void Scheduler::wait_for_news() {
  constexpr int milliseconds = 20;
  std::vector<pollfd> descriptors;
  for (const Job& job : jobs_)
    descriptors.push_back({job.process.progress_descriptor(), POLLIN, 0});
  poll(descriptors.data(), descriptors.size(), milliseconds);
  for (Job& job : jobs_) job.process.read_progress();
  // A closed pipe is always ready: the process is about to end.
  const auto is_closed = [](const pollfd& d) { return (d.revents & POLLHUP) != 0; };
  if (std::ranges::any_of(descriptors, is_closed)) usleep(1000);
}

void Scheduler::collect_ended_jobs() {
  std::erase_if(jobs_, [&](Job& job) {
    if (!job.process.has_ended()) return false;
    job.process.read_progress();
    end_of(job);
    free_slots_ += job.threads;
    return true;
  });
}

void Scheduler::end_of(const Job& job) {
  const Node& node = plan_.nodes[job.node];
  const int status = job.process.exit_status();
  spent_ += spent(job);
  // Another run may have begun to make its own report in place of this one.
  if (status == 0 && (node.stage == Stage::report || is_complete(plan_, node))) {
    states_[job.node] = State::done;
    ++num_made_;
    costs_.learn(node, spent(job));
    if (!job.process.said().empty()) lines_.clear();
    for (const std::string& line : job.process.said()) {
      print(fmt::format("npdr: {}: {}\n", node.label(), line));
    }
    return;
  }
  states_[job.node] = State::failed;
  // A child that was told to stop before it could listen has done nothing yet.
  if (status == static_cast<int>(ExitStatus::checkpointed) || is_stop_signal(status - 128)) {
    stopping_ = true;
    if (stop_requested()) return;  // else somebody stopped that job alone
  } else {
    log_failure(job.log.path, node.key, status, job.process.said());
    const bool is_known = status == 2 || status == 3;
    const ExitStatus failure = is_known ? static_cast<ExitStatus>(status) : ExitStatus::failed;
    if (status_ == ExitStatus::done) status_ = failure;
  }
  lines_.clear();
  print(failures_.tell(node.label(), status, job.process.said(), job.log));
}

void Scheduler::pass_on_stop_request() {
  stopping_ = true;
  passed_on_ = true;
  lines_.clear();
  print(
      "npdr: stopping when work is saved (a second Ctrl-C, a second later or more: at once); run "
      "it again to go on\n");
  for (const Job& job : jobs_) job.process.send_signal(SIGTERM);
}

double Scheduler::spent(const Job& job) {
  return seconds_since(job.start) * static_cast<double>(job.threads);
}

std::optional<double> Scheduler::left(const Job& job) const {
  const ChildProcess::State& state = job.process.state();
  // Where all is done and it goes on, it is at something that it doesn't count.
  if (state.done > state.begun && state.done < state.total) {
    return spent(job) * static_cast<double>(state.total - state.done) /
           static_cast<double>(state.done - state.begun);
  }
  const std::optional<double> expected = costs_.expected(plan_.nodes[job.node]);
  if (!expected) return std::nullopt;
  // What has taken longer than others may well take as long again.
  return *expected > spent(job) ? *expected - spent(job) : spent(job);
}

std::optional<double> Scheduler::share_done() const {
  double done = spent_;
  WorkLeft rest;
  for (const Job& job : jobs_) {
    done += spent(job);
    rest.add(plan_.nodes[job.node].stage, left(job));
  }
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Node& node = plan_.nodes[i];
    if (states_[i] == State::waiting) rest.add(node.stage, costs_.expected(node));
  }
  return rest.share_done(done, num_made_);
}

std::string Scheduler::job_text(const Job& job) const {
  const Node& node = plan_.nodes[job.node];
  const ChildProcess::State& state = job.process.state();
  std::string text = node.label();
  if (state.done > 0) {
    text += fmt::format(": {}", state.done);
    if (state.total > 0) text += fmt::format(" of {}", state.total);
    text += unit_of(plan_, node);
  }
  if (!state.note.empty()) text += ", " + state.note;
  return text + silence_text(job.process.silence());
}

void Scheduler::show_progress(bool force) {
  const double wait = lines_.is_terminal() ? 0.2 : 60.0;
  if (!force && seconds_since(shown_) < wait) return;
  shown_ = Clock::now();
  RunProgress run{.study = plan_.study.name,
                  .num_made = num_made_,
                  .num_missing = num_missing_,
                  .seconds = seconds_since(start_)};
  if (const std::optional<double> share = share_done()) {
    shown_share_ = std::max(shown_share_, *share);
    if (*share > 0.0) run.seconds_left = run.seconds * (1.0 - *share) / *share;
  }
  if (shown_share_ > 0.0) run.share = shown_share_;
  for (const Job& job : jobs_) run.jobs.push_back(job_text(job));
  if (lines_.is_terminal() && !force) {
    lines_.show(live_lines(run, lines_.size()));
    return;
  }
  lines_.clear();
  print(log_line(run) + "\n");
}

}  // namespace npdr::pipeline
