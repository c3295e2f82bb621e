#include "pipeline/sources/external_simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/text.h"
#include "pipeline/process/progress.h"
#include "pipeline/sources/row_simulator.h"
#include "sim/segments.h"
#include "sim/simulator_check.h"

namespace npdr::pipeline {
namespace {

using sim::RolloutStatus;

constexpr std::size_t kLargestLog = 1 << 20;
constexpr std::size_t kTailLines = 20;

std::string tail_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::string tail;
  const std::size_t first = lines.size() > kTailLines ? lines.size() - kTailLines : 0;
  for (std::size_t i = first; i < lines.size(); ++i) tail += "\n  " + lines[i];
  return tail;
}

// Row i of `part` is that of `whole` with the number rows[i].
void give_back(const sim::Trajectories& part, const std::vector<Index>& rows,
               sim::Trajectories& whole) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::ranges::copy(part.row(static_cast<Index>(i)), whole.row(rows[i]).begin());
    whole.status[static_cast<std::size_t>(rows[i])] = part.status[i];
  }
}

}  // namespace

Index hopeless_rows(double max_failed_fraction) {
  constexpr double level = 1e-9;
  if (max_failed_fraction >= 1.0) return std::numeric_limits<Index>::max();
  const double rows = std::ceil(std::log(level) / std::log(max_failed_fraction));
  return static_cast<Index>(std::max(rows, 4.0));
}

ExternalSimulator::ExternalSimulator(const ExternalConfig& external, sim::SimulatorInfo info,
                                     std::unique_ptr<ProgramCall> program,
                                     std::filesystem::path log, Index hopeless_rows)
    : info_(std::move(info)),
      folder_(external.folder),
      time_limit_(external.time_limit),
      start_time_(external.start_time),
      retries_(external.retries),
      program_(std::move(program)),
      log_path_(std::move(log)),
      hopeless_rows_(hopeless_rows) {}

ExternalSimulator::~ExternalSimulator() { write_log(); }

void ExternalSimulator::log_to(std::filesystem::path log) {
  write_log();
  log_path_ = std::move(log);
  log_.clear();
}

void ExternalSimulator::write_log() {
  if (log_.empty() || log_path_.empty()) return;
  try {
    write_text_file(log_path_, log_);
  } catch (...) {  // no result is worth less without it
  }
}

sim::Trajectories ExternalSimulator::simulate(const RowMatrix& theta, const StreamId& first,
                                              Index num_rows) {
  std::vector<Index> possible;
  Task whole{theta, std::max(num_rows, theta.rows()), {}, {}, {}};
  for (Index i = 0; i < theta.rows(); ++i) {
    whole.seeds.push_back(row_seed(first, i));
    whole.rows.push_back(first.row + static_cast<std::uint64_t>(i));
    if (sim::is_possible(theta.row(i), info_)) possible.push_back(i);
  }
  Task task = part_of(whole, possible);
  if (!possible.empty()) solve(task, 0, task.theta.rows(), false);
  repeat_named(task);
  if (!task.named.empty()) loss_ = task.why;
  count_last_named(task);
  if (std::ssize(possible) == theta.rows()) return std::move(task.result);
  sim::Trajectories all = program_->empty(theta.rows());
  for (Index i = 0; i < theta.rows(); ++i) {
    sim::lose_row(i, RolloutStatus::out_of_limits, all);
  }
  give_back(task.result, possible, all);
  return all;
}

double ExternalSimulator::time_limit(Index count, Index num_rows) const {
  if (count == num_rows) return time_limit_;
  const double share = static_cast<double>(count) / static_cast<double>(num_rows);
  return std::min(time_limit_, start_time_ + share * time_limit_);
}

ExternalSimulator::Task ExternalSimulator::part_of(const Task& task,
                                                   const std::vector<Index>& rows) const {
  Task part{task.theta(rows, Eigen::all), task.num_rows, {}, {}, program_->empty(std::ssize(rows))};
  for (const Index row : rows) {
    part.seeds.push_back(task.seeds[static_cast<std::size_t>(row)]);
    part.rows.push_back(task.rows[static_cast<std::size_t>(row)]);
  }
  return part;
}

// Rows [begin, end). `is_bad`: they are known to fail together.
void ExternalSimulator::solve(Task& task, Index begin, Index end, bool is_bad) {
  const Index count = end - begin;
  const bool is_whole = count == task.theta.rows();
  RolloutStatus status = RolloutStatus::ok;
  if (!is_bad || count == 1) {
    const bool is_repeated = is_whole || count == 1;
    if (is_repeated ? repeat(task, begin, end, status) : call(task, begin, end, status)) return;
  }
  if (count == 1) {
    give_up(task, begin, status);
    return;
  }
  if (is_whole && !good_ && count > hopeless_rows_) require_a_good_row(task, begin, end);
  const Index middle = begin + count / 2;
  const Index lost_before = task.num_lost;
  solve(task, begin, middle, false);
  solve(task, middle, end, task.num_lost == lost_before);
}

// Rows spread over the first call, which has failed.
void ExternalSimulator::require_a_good_row(Task& task, Index begin, Index end) {
  RolloutStatus status = RolloutStatus::ok;
  for (Index k = 0; k < hopeless_rows_; ++k) {
    const Index row = begin + k * (end - begin - 1) / (hopeless_rows_ - 1);
    if (call(task, row, row + 1, status) && good_) return;
  }
  fail(fmt::format("failed for each of {} rows", hopeless_rows_), last_failure_);
}

// Asks for the rows that the program named in one more call: the one before may have been to blame.
// Calls that bring some of them back aren't counted.
void ExternalSimulator::repeat_named(Task& task) {
  for (Index attempt = 0; attempt < retries_ && !task.named.empty();) {
    const std::vector<Index> rows(task.named.begin(), task.named.end());
    Task again = part_of(task, rows);
    RolloutStatus status = RolloutStatus::ok;
    const bool is_done = call(again, 0, std::ssize(rows), status);
    if (!is_done || again.named.size() == rows.size()) ++attempt;
    if (!is_done) continue;
    give_back(again.result, rows, task.result);
    task.why = again.why;
    task.named.clear();
    for (const Index i : again.named) task.named.insert(rows[static_cast<std::size_t>(i)]);
  }
}

bool ExternalSimulator::repeat(Task& task, Index begin, Index end, RolloutStatus& status) {
  for (Index attempt = 0; attempt <= retries_; ++attempt) {
    if (call(task, begin, end, status)) return true;
  }
  return false;
}

// One call. False, and the status of a row that it would be about, when it failed.
bool ExternalSimulator::call(Task& task, Index begin, Index end, RolloutStatus& status) {
  const Index count = end - begin;
  const ProgramRows rows{
      task.theta.middleRows(begin, count),
      std::span(task.seeds)
          .subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(count)),
      task.rows[static_cast<std::size_t>(begin)] % kNoRow, time_limit(count, task.num_rows)};
  ++num_calls_;
  sim::Trajectories result = program_->empty(count);
  const ProgramOutcome outcome = program_->call(rows, result);
  if (outcome.lost) {
    const auto row = static_cast<std::size_t>(begin + outcome.lost->row);
    lost_number_ = fmt::format("row {} has {}", task.rows[row] % kNoRow, outcome.lost->words);
  }
  note(fmt::format("call {}, {} rows from row {}: {}", num_calls_, count, rows.first_row,
                   outcome.summary),
       outcome, task);
  if (outcome.cannot_run) fail("can't be run", outcome.problem + tail_of(outcome.output));
  status = outcome.status;
  if (!outcome.succeeded) {
    report_note(fmt::format("a call of {} rows failed: {}", count, shortened(outcome.problem)));
  }
  if (!outcome.warnings.empty()) last_warnings_ = outcome.warnings;
  if (!outcome.succeeded) return false;
  const Index num_named = std::ranges::count(result.status, RolloutStatus::crashed);
  if (num_named > 0) {
    task.why = outcome.problem + tail_of(outcome.output);
    report_note(
        fmt::format("{} of {} rows failed: {}", num_named, count, shortened(outcome.problem)));
  }
  take(task, begin, result);
  return true;
}

// Rows that the program named need no further calls to be found.
void ExternalSimulator::take(Task& task, Index begin, const sim::Trajectories& rows) {
  std::ranges::copy(rows.values, task.result.row(begin).begin());
  std::ranges::copy(rows.status, task.result.status.begin() + begin);
  std::optional<Index> good;
  for (Index i = begin; i < begin + rows.num_rows; ++i) {
    if (task.result.status[static_cast<std::size_t>(i)] == RolloutStatus::crashed) {
      task.named.insert(i);
    } else {
      task.named.erase(i);
      good = i;
    }
  }
  if (good) keep_as_good(task, *good);
}

void ExternalSimulator::keep_as_good(const Task& task, Index row) {
  good_ = part_of(task, {row});
  num_lost_ = 0;
}

void ExternalSimulator::give_up(Task& task, Index row, RolloutStatus status) {
  sim::lose_row(row, status, task.result);
  task.named.erase(row);
  ++task.num_lost;
  loss_ = last_failure_;
  count_lost(1);
}

void ExternalSimulator::count_last_named(const Task& task) {
  Index count = 0;
  while (task.named.contains(task.theta.rows() - 1 - count)) ++count;
  count_lost(count);
}

// Of many rows in a row a good one tells whether they fail, or the program, its licence, the disk.
void ExternalSimulator::count_lost(Index count) {
  num_lost_ += count;
  if (num_lost_ < hopeless_rows_) return;
  const Index num_lost = std::exchange(num_lost_, 0);
  if (!good_) fail(fmt::format("failed for each of {} rows", num_lost), last_failure_);
  Task again = *std::exchange(good_, std::nullopt);
  RolloutStatus status = RolloutStatus::ok;
  if (repeat(again, 0, 1, status) && good_) return;
  fail(fmt::format("failed for the last {} rows, and then for one that it had simulated before",
                   num_lost),
       last_failure_);
}

// Keeps the first failure: those after it are its repetitions, of fewer and fewer rows.
void ExternalSimulator::note(const std::string& heading, const ProgramOutcome& outcome,
                             Task& task) {
  if (!outcome.problem.empty() && !task.has_failed) {
    last_failure_ = outcome.problem + tail_of(outcome.output);
    task.has_failed = true;
  }
  if (log_.size() > kLargestLog) return;
  log_ += heading + "\n";
  if (!outcome.problem.empty() && outcome.problem != outcome.summary)
    log_ += outcome.problem + "\n";
  if (outcome.lost) log_ += lost_number_ + "\n";
  log_ += outcome.output;
  if (!outcome.output.empty() && outcome.output.back() != '\n') log_ += '\n';
  if (log_.size() > kLargestLog) log_ += "... further calls aren't logged\n";
}

void ExternalSimulator::fail(const std::string& what, const std::string& why) const {
  std::string text =
      fmt::format("{} {}: {}\n  in the folder {}", program_->words(), what, why, folder_);
  if (!log_path_.empty()) text += "; all that it printed: " + log_path_.string();
  throw Error(text);
}

}  // namespace npdr::pipeline
