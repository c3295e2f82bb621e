#include "pipeline/sources/external_simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <sstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/feature_names.h"
#include "core/text.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/sources/call_files.h"
#include "pipeline/sources/command_text.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

using sim::RolloutStatus;

// A shell's statuses for a program that isn't there or can't be run.
constexpr int kCannotRun = 126;
constexpr int kNotFound = 127;

// So many rows that fail one after the other, and none that doesn't: the fault isn't theirs. With
// half of all rows failing that happens by chance to one shard of 2^32; smaller shards aren't
// judged below the lower number.
constexpr Index kHopelessRows = 32;
constexpr Index kFewestHopelessRows = 8;

constexpr std::size_t kLargestLog = 1 << 20;
constexpr std::size_t kTailLines = 10;

std::string tail_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::string tail;
  const std::size_t first = lines.size() > kTailLines ? lines.size() - kTailLines : 0;
  for (std::size_t i = first; i < lines.size(); ++i) tail += "\n  " + lines[i];
  return tail;
}

// Held while the files of a call are written and read: HDF5 serves one thread at a time.
std::unique_lock<std::mutex> lock_files(FileFormat format) {
  static std::mutex hdf5;
  return format == FileFormat::hdf5 ? std::unique_lock(hdf5) : std::unique_lock<std::mutex>();
}

// Fits into a signed 32-bit integer, as many programs want it.
std::uint32_t seed_of(StreamId id, Index i) {
  id.row += static_cast<std::uint64_t>(i);
  return Stream(id).bits() >> 1;
}

}  // namespace

ExternalSimulator::ExternalSimulator(ExternalConfig external, sim::SimulatorInfo info,
                                     std::filesystem::path log, int threads)
    : external_(std::move(external)),
      info_(std::move(info)),
      log_path_(std::move(log)),
      threads_(threads) {}

ExternalSimulator::~ExternalSimulator() {
  if (num_calls_ == 0 || log_path_.empty()) return;
  try {
    write_text_file(log_path_, log_);
  } catch (...) {  // no result is worth less without it
  }
}

sim::Trajectories ExternalSimulator::simulate(const RowMatrix& theta, const StreamId& first) {
  Task task{theta, {}, first.row, {}};
  for (Index i = 0; i < theta.rows(); ++i) task.seeds.push_back(seed_of(first, i));
  task.result.resize(theta.rows(), 1, 1, static_cast<Index>(info_.state_channels.size()));
  if (theta.rows() > 0) solve(task, 0, theta.rows(), false);
  return std::move(task.result);
}

double ExternalSimulator::time_limit(Index count, Index num_rows) const {
  if (count == num_rows) return external_.time_limit;
  const double share = static_cast<double>(count) / static_cast<double>(num_rows);
  return std::min(external_.time_limit, external_.start_time + share * external_.time_limit);
}

// Rows [begin, end). `is_bad`: they are known to fail together.
void ExternalSimulator::solve(Task& task, Index begin, Index end, bool is_bad) {
  const Index count = end - begin;
  const bool is_whole = count == task.theta.rows();
  RolloutStatus status = RolloutStatus::ok;
  if (!is_bad || count == 1) {
    const bool is_repeated = is_whole || count == 1;
    if (is_repeated ? repeat(task, begin, end, status) : call(task, begin, end, status)) {
      task.num_done += count;
      return;
    }
  }
  if (count == 1) {
    give_up(task, begin, status);
    return;
  }
  const Index middle = begin + count / 2;
  const Index lost_before = task.num_lost;
  solve(task, begin, middle, false);
  solve(task, middle, end, task.num_lost == lost_before);
}

bool ExternalSimulator::repeat(Task& task, Index begin, Index end, RolloutStatus& status) {
  for (Index attempt = 0; attempt <= external_.retries; ++attempt) {
    if (call(task, begin, end, status)) return true;
  }
  return false;
}

// One call. False, and the status of a row that it would be about, when it failed.
bool ExternalSimulator::call(Task& task, Index begin, Index end, RolloutStatus& status) {
  const Index count = end - begin;
  const CallFolder folder(external_.format);
  {
    const std::unique_lock lock = lock_files(external_.format);
    write_theta_file(folder.theta(), external_.format, info_.parameters,
                     task.theta.middleRows(begin, count));
  }
  write_seeds_file(folder.seeds(),
                   std::span(task.seeds)
                       .subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(count)));
  const std::uint64_t first_row = task.first_row + static_cast<std::uint64_t>(begin);
  const ShellCall shell{filled_command(*external_.command, folder.theta(), folder.x()),
                        external_.folder,
                        {{"NPDR_SEEDS", folder.seeds()},
                         {"NPDR_FIRST_ROW", std::to_string(first_row)},
                         {"OMP_NUM_THREADS", std::to_string(threads_)}},
                        time_limit(count, task.theta.rows())};
  ++num_calls_;
  const CallResult result = run_shell(shell);
  const std::string heading = fmt::format("call {}, {} rows from row {}: {}", num_calls_, count,
                                          first_row, result.words(shell.time_limit));
  if (!result.succeeded()) {
    status = result.timed_out ? RolloutStatus::timed_out : RolloutStatus::crashed;
    note(heading, result, result.words(shell.time_limit));
    if (!result.timed_out &&
        (result.exit_status == kNotFound || result.exit_status == kCannotRun)) {
      fail("can't be run");
    }
    return false;
  }
  try {
    const FeatureRows rows = [&] {
      const std::unique_lock lock = lock_files(external_.format);
      return read_features(folder.x(), external_.format, count, info_.state_channels);
    }();
    for (Index i = 0; i < count; ++i) {
      const std::span<float> out = task.result.row(begin + i);
      std::transform(rows.x.row(i).begin(), rows.x.row(i).end(), out.begin(),
                     [](double value) { return static_cast<float>(value); });
      const bool is_finite = std::ranges::all_of(out, [](float v) { return std::isfinite(v); });
      task.result.status[static_cast<std::size_t>(begin + i)] =
          is_finite ? RolloutStatus::ok : RolloutStatus::diverged;
      if (!is_finite) std::ranges::fill(out, std::numeric_limits<float>::quiet_NaN());
    }
    note(heading, result, "");
    return true;
  } catch (const InputError& error) {
    status = RolloutStatus::bad_output;
    note(
        heading, result,
        fmt::format("{}; x must have {}: {}, as simulator.features or else target.observation says",
                    error.what(), counted(std::ssize(info_.state_channels), "column"),
                    join(few_shortened(feature_names(info_.state_channels)))));
    return false;
  }
}

void ExternalSimulator::give_up(Task& task, Index row, RolloutStatus status) {
  ++task.num_lost;
  std::ranges::fill(task.result.row(row), std::numeric_limits<float>::quiet_NaN());
  task.result.status[static_cast<std::size_t>(row)] = status;
  const Index hopeless = std::min(task.theta.rows(), kHopelessRows);
  if (task.num_done == 0 && task.num_lost >= std::max(hopeless, kFewestHopelessRows)) {
    fail(fmt::format("failed for each of {} rows", task.num_lost));
  }
}

void ExternalSimulator::note(const std::string& heading, const CallResult& result,
                             const std::string& problem) {
  if (!problem.empty()) last_failure_ = problem + tail_of(result.output);
  if (log_.size() > kLargestLog) return;
  log_ += heading + "\n";
  if (!problem.empty() && !result.timed_out && result.exit_status == 0) log_ += problem + "\n";
  log_ += result.output;
  if (!result.output.empty() && result.output.back() != '\n') log_ += '\n';
  if (log_.size() > kLargestLog) log_ += "... further calls aren't logged\n";
}

void ExternalSimulator::fail(const std::string& what) const {
  std::string text = fmt::format("simulator.command = '{}' {}: {}\n  in the folder {}",
                                 *external_.command, what, last_failure_, external_.folder);
  if (!log_path_.empty()) text += "; all that it printed: " + log_path_.string();
  throw Error(text);
}

}  // namespace npdr::pipeline
