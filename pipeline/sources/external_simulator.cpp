#include "pipeline/sources/external_simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/text.h"
#include "pipeline/process/progress.h"
#include "pipeline/sources/source.h"
#include "sim/segments.h"
#include "sim/simulator_check.h"

namespace npdr::pipeline {
namespace {

using sim::RolloutStatus;

constexpr std::size_t kLargestLog = 1 << 20;
constexpr std::size_t kTailLines = 20;

std::string tail_of(const std::string& text) {
  const std::vector<std::string> lines = split(text, '\n');
  std::string tail;
  const std::size_t first = lines.size() > kTailLines ? lines.size() - kTailLines : 0;
  for (std::size_t i = first; i < lines.size(); ++i) tail += "\n  " + lines[i];
  return tail;
}

}  // namespace

double chance_of_failures(Index num_failed, Index num_rows, double max_failed_fraction) {
  if (num_failed == 0 || max_failed_fraction >= 1.0) return 1.0;
  const auto log_factorial = [](Index i) { return std::lgamma(static_cast<double>(i) + 1.0); };
  double chance = 0.0;
  for (Index i = num_failed; max_failed_fraction > 0.0 && i <= num_rows; ++i) {
    const auto failed = static_cast<double>(i), good = static_cast<double>(num_rows - i);
    chance +=
        std::exp(log_factorial(num_rows) - log_factorial(i) - log_factorial(num_rows - i) +
                 failed * std::log(max_failed_fraction) + good * std::log1p(-max_failed_fraction));
  }
  return chance;
}

Index hopeless_rows(double max_failed_fraction) {
  if (max_failed_fraction >= 1.0) return std::numeric_limits<Index>::max();
  const double rows = std::ceil(std::log(kHopelessChance) / std::log(max_failed_fraction));
  return static_cast<Index>(std::max(rows, 4.0));
}

ExternalSimulator::ExternalSimulator(Program program, std::filesystem::path log,
                                     Index hopeless_rows)
    : program_(std::move(program)),
      call_(program_.external.worker ? make_worker_call(program_) : make_file_call(program_)),
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

std::uint64_t ExternalSimulator::Work::number(Index row) const {
  return (first.row + static_cast<std::uint64_t>(row)) % kNoRow;
}

ExternalSimulator::Work ExternalSimulator::begin(const RowMatrix& theta, const StreamId& first,
                                                 Index num_rows) const {
  Work work{theta, first, num_rows, {}, {}};
  work.result = sim::empty_trajectories(program_.segments, theta.rows(), program_.store_every);
  for (Index i = 0; i < theta.rows(); ++i) {
    if (sim::is_possible(theta.row(i), program_.info)) {
      work.rows.push_back(i);
    } else {
      sim::lose_row(i, RolloutStatus::out_of_limits, work.result);
    }
  }
  return work;
}

sim::Trajectories ExternalSimulator::simulate(const RowMatrix& theta, const StreamId& first,
                                              Index num_rows) {
  Work work = begin(theta, first, std::max(num_rows, theta.rows()));
  if (!work.rows.empty()) solve(work, work.rows, false);
  repeat_named(work);
  if (!work.named.empty()) loss_ = work.why;
  const auto is_named = [&](Index row) { return work.named.contains(row); };
  const auto last = std::find_if_not(work.rows.rbegin(), work.rows.rend(), is_named);
  count_lost(last - work.rows.rbegin());
  return std::move(work.result);
}

double ExternalSimulator::time_limit(Index count, Index num_rows) const {
  const ExternalConfig& external = program_.external;
  const double share = static_cast<double>(count) / static_cast<double>(num_rows);
  return std::min(external.time_limit, external.start_time + share * external.time_limit);
}

// `is_bad`: the rows are known to fail together.
void ExternalSimulator::solve(Work& work, Rows rows, bool is_bad) {
  const bool is_one = rows.size() == 1, are_all = rows.size() == work.rows.size();
  RolloutStatus status = RolloutStatus::ok;
  if (!is_bad || is_one) {
    status = is_one || are_all ? repeat(work, rows) : call(work, rows);
    if (status == RolloutStatus::ok) return;
  }
  if (is_one) {
    give_up(work, rows.front(), status);
    return;
  }
  if (are_all && !good_ && std::ssize(rows) > hopeless_rows_) require_a_good_row(work);
  const std::size_t half = rows.size() / 2;
  const Index lost_before = work.num_lost;
  solve(work, rows.first(half), false);
  solve(work, rows.subspan(half), work.num_lost == lost_before);
}

// Rows spread over the first call, which has failed.
void ExternalSimulator::require_a_good_row(Work& work) {
  const Rows rows = work.rows;
  for (Index k = 0; k < hopeless_rows_; ++k) {
    const Index at = k * (std::ssize(rows) - 1) / (hopeless_rows_ - 1);
    const RolloutStatus status = call(work, rows.subspan(static_cast<std::size_t>(at), 1));
    if (status == RolloutStatus::ok && good_) return;
  }
  fail(fmt::format("failed for each of {} rows", hopeless_rows_), last_failure_);
}

// Asks for the rows that the program named in one more call: the one before may have been to blame.
// Calls that bring some of them back aren't counted.
void ExternalSimulator::repeat_named(Work& work) {
  for (Index attempt = 0; attempt < program_.external.retries && !work.named.empty();) {
    const std::vector<Index> rows(work.named.begin(), work.named.end());
    call(work, rows);
    if (work.named.size() == rows.size()) ++attempt;
  }
}

RolloutStatus ExternalSimulator::repeat(Work& work, Rows rows) {
  RolloutStatus status = call(work, rows);
  for (Index i = 0; i < program_.external.retries && status != RolloutStatus::ok; ++i) {
    status = call(work, rows);
  }
  return status;
}

// One call. When it failed, the status of a row that it would be about.
RolloutStatus ExternalSimulator::call(Work& work, Rows rows) {
  const Index count = std::ssize(rows);
  ProgramRows asked{work.theta(std::vector<Index>(rows.begin(), rows.end()), Eigen::all),
                    {},
                    work.number(rows.front()),
                    time_limit(count, work.num_rows)};
  for (const Index row : rows) asked.seeds.push_back(row_seed(work.first, row));
  const ProgramReply reply = call_->call(asked);
  ++num_calls_;
  note(fmt::format("call {}, {} rows from row {}: {}", num_calls_, count, asked.first_row,
                   reply.summary),
       reply, work);
  if (reply.cannot_run) fail("can't be run", reply.problem + tail_of(reply.output));
  if (!reply.warnings.empty()) last_warnings_ = reply.warnings;
  if (reply.succeeded()) take(work, rows, reply);
  const Index num_failed =
      reply.succeeded() ? std::ranges::count(reply.row_status, RolloutStatus::crashed) : count;
  if (num_failed > 0) {
    if (reply.succeeded()) work.why = reply.problem + tail_of(reply.output);
    report_note(
        fmt::format("{} of {} rows failed: {}", num_failed, count, shortened(reply.problem)));
  }
  return reply.status;
}

// Rows that the program named need no further calls to be found.
void ExternalSimulator::take(Work& work, Rows rows, const ProgramReply& reply) {
  const std::size_t size = reply.states.size() / rows.size();
  std::string lost;
  std::optional<Index> good;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Index row = rows[i];
    if (reply.row_status[i] == RolloutStatus::crashed) {
      sim::lose_row(row, RolloutStatus::crashed, work.result);
      work.named.insert(row);
      continue;
    }
    const auto states = reply.states.subspan(i * size, size);
    const std::string words = store(work, row, reply.row_status[i], states);
    if (lost.empty()) lost = words;
    work.named.erase(row);
    good = row;
  }
  if (!lost.empty()) {
    lost_number_ = lost;
    log(lost + "\n");
  }
  if (!good) return;
  good_ = begin(work.theta.row(*good), row_after(work.first, *good), work.num_rows);
  num_lost_ = 0;
}

// Gives the words of a number that made the row diverge.
std::string ExternalSimulator::store(Work& work, Index row, RolloutStatus status,
                                     std::span<const double> states) const {
  const sim::Segments& segments = program_.segments;
  RolloutStatus& stored = work.result.status[static_cast<std::size_t>(row)];
  stored = RolloutStatus::ok;
  if (status == RolloutStatus::ok) {
    sim::store_states(segments, states.data(), program_.store_every, row, work.result);
  } else {
    sim::lose_row(row, status, work.result);
  }
  if (stored != RolloutStatus::diverged) return "";
  const std::string words = find_lost_number(states, program_.info.state_channels,
                                             segments.num_steps() / segments.num_rollouts);
  return words.empty() ? "" : fmt::format("row {} has {}", work.number(row), words);
}

void ExternalSimulator::give_up(Work& work, Index row, RolloutStatus status) {
  sim::lose_row(row, status, work.result);
  work.named.erase(row);
  ++work.num_lost;
  loss_ = last_failure_;
  count_lost(1);
}

// Of many rows in a row a good one tells whether they fail, or the program, its licence, the disk.
void ExternalSimulator::count_lost(Index count) {
  num_lost_ += count;
  if (num_lost_ < hopeless_rows_) return;
  const Index num_lost = std::exchange(num_lost_, 0);
  if (!good_) fail(fmt::format("failed for each of {} rows", num_lost), last_failure_);
  Work again = *std::exchange(good_, std::nullopt);
  if (repeat(again, again.rows) == RolloutStatus::ok && good_) return;
  fail(fmt::format("failed for the last {} rows, and then for one that it had simulated before",
                   num_lost),
       last_failure_);
}

// Keeps the first failure: those after it are its repetitions, of fewer and fewer rows.
void ExternalSimulator::note(const std::string& heading, const ProgramReply& reply, Work& work) {
  if (!reply.problem.empty() && !work.has_failed) {
    last_failure_ = reply.problem + tail_of(reply.output);
    work.has_failed = true;
  }
  log(heading + "\n");
  if (!reply.problem.empty() && reply.problem != reply.summary) log(reply.problem + "\n");
  log(reply.output);
  if (!reply.output.empty() && reply.output.back() != '\n') log("\n");
}

void ExternalSimulator::log(const std::string& text) {
  if (log_.size() > kLargestLog) return;
  log_ += text;
  if (log_.size() > kLargestLog) log_ += "\n... further calls aren't logged\n";
}

void ExternalSimulator::fail(const std::string& what, const std::string& why) const {
  std::string text = fmt::format("{} {}: {}\n  in the folder {}", program_.words(), what, why,
                                 program_.external.folder);
  if (!log_path_.empty()) text += "; all that it printed: " + log_path_.string();
  throw Error(text);
}

}  // namespace npdr::pipeline
