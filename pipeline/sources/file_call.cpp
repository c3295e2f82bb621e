#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include "core/error.h"
#include "core/feature_names.h"
#include "core/shell_call.h"
#include "core/text.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/sources/call_files.h"
#include "pipeline/sources/command_text.h"
#include "pipeline/sources/failed_rows.h"
#include "pipeline/sources/precision.h"
#include "pipeline/sources/program_call.h"
#include "pipeline/sources/python_path.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

using sim::RolloutStatus;

// A shell's statuses for a program that isn't there or can't be run.
constexpr int kCannotRun = 126;
constexpr int kNotFound = 127;

// Held while the files of a call are written and read: HDF5 serves one thread at a time.
std::unique_lock<std::mutex> lock_files(FileFormat format) {
  static std::mutex hdf5;
  return format == FileFormat::hdf5 ? std::unique_lock(hdf5) : std::unique_lock<std::mutex>();
}

void take_features(const RowMatrix& x, sim::Trajectories& result) {
  for (Index i = 0; i < x.rows(); ++i) {
    const std::span<float> out = result.row(i);
    std::ranges::transform(x.row(i), out.begin(), [](double v) { return static_cast<float>(v); });
    const bool is_finite = std::ranges::all_of(out, [](float v) { return std::isfinite(v); });
    if (!is_finite) sim::lose_row(i, RolloutStatus::diverged, result);
  }
}

class FileCall final : public ProgramCall {
 public:
  FileCall(const ExternalConfig& external, const sim::SimulatorInfo& info,
           const ProgramInputs* inputs, int threads)
      : external_(external), info_(info), threads_(threads) {
    if (inputs != nullptr) inputs_ = *inputs;
  }

  ProgramOutcome call(const ProgramRows& rows, sim::Trajectories& result) override {
    const CallFolder folder(external_.format);
    const ShellCall shell = prepare(rows, folder);
    const CallResult ended = run_shell(shell);
    ProgramOutcome outcome;
    outcome.summary = ended.words(shell.time_limit);
    outcome.output = ended.output;
    if (!ended.succeeded()) {
      outcome.succeeded = false;
      outcome.problem = outcome.summary;
      outcome.status = ended.timed_out ? RolloutStatus::timed_out : RolloutStatus::crashed;
      outcome.cannot_run =
          !ended.timed_out && (ended.exit_status == kNotFound || ended.exit_status == kCannotRun);
      return outcome;
    }
    try {
      read_result(folder, result, outcome);
    } catch (const InputError& error) {
      outcome.succeeded = false;
      outcome.status = RolloutStatus::bad_output;
      outcome.problem = error.what();
    }
    return outcome;
  }

  sim::Trajectories empty(Index num_rows) const override {
    if (inputs_) return sim::empty_trajectories(inputs_->segments, num_rows, inputs_->store_every);
    sim::Trajectories result;
    result.resize(num_rows, 1, 1, std::ssize(info_.state_channels));
    return result;
  }

  std::string words() const override {
    return fmt::format("simulator.command = '{}'", *external_.command);
  }

 private:
  ShellCall prepare(const ProgramRows& rows, const CallFolder& folder) const {
    std::map<std::string, std::string> environment = {
        {"NPDR_SEEDS", folder.seeds()},
        {"NPDR_FAILED", folder.failed()},
        {"NPDR_FIRST_ROW", std::to_string(rows.first_row)},
        {"PYTHONPATH", python_path()},
        {"OMP_NUM_THREADS", std::to_string(threads_)}};
    write_seeds_file(folder.seeds(), rows.seeds);
    const std::unique_lock lock = lock_files(external_.format);
    write_theta_file(folder.theta(), external_.format, info_.parameters, rows.theta);
    if (inputs_) {
      write_segment_files(folder, external_.format, info_, inputs_->segments);
      environment["NPDR_SEGMENTS"] = folder.segments();
      environment["NPDR_ACTIONS"] = folder.actions();
      environment["NPDR_DT"] = fmt::format("{}", inputs_->segments.dt);
    }
    return {{filled_command(*external_.command, folder.theta(), folder.x()), external_.folder,
             environment},
            rows.time_limit};
  }

  // Of one rollout; of features 0.
  Index num_steps() const {
    return inputs_ ? inputs_->segments.num_steps() / inputs_->segments.num_rollouts : 0;
  }

  // Throws InputError, as read_result().
  RowMatrix read_rows(const CallFolder& folder, Index count) const {
    const Index lines = inputs_ ? count * inputs_->segments.num_steps() : count;
    const std::unique_lock lock = lock_files(external_.format);
    try {
      return read_features(folder.x(), external_.format, lines, info_.state_channels,
                           {external_.names_from, true})
          .x;
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}; x must have {}", error.what(), expected_columns()));
    }
  }

  void read_result(const CallFolder& folder, sim::Trajectories& result,
                   ProgramOutcome& outcome) const {
    const auto failed = read_failed_rows(folder.failed(), result.num_rows);
    RowMatrix x;
    if (std::ssize(failed) < result.num_rows) {
      x = read_rows(folder, result.num_rows);
      inputs_ ? take_states(x, result) : take_features(x, result);
    }
    for (const auto& [row, why] : failed) sim::lose_row(row, RolloutStatus::crashed, result);
    if (!failed.empty()) outcome.problem = failed.rbegin()->second;
    outcome.lost = first_lost_number({x.data(), static_cast<std::size_t>(x.size())}, result,
                                     info_.state_channels, num_steps());
    // Of motion the recording says it (first_rows.cpp).
    if (!inputs_) outcome.warnings = find_lost_precision(x, info_.state_channels);
  }

  void take_states(const RowMatrix& x, sim::Trajectories& result) const {
    const Index row_size = inputs_->segments.num_steps() * x.cols();
    for (Index i = 0; i < result.num_rows; ++i) {
      sim::store_states(inputs_->segments, x.data() + i * row_size, inputs_->store_every, i,
                        result);
    }
  }

  std::string expected_columns() const {
    const std::string names = join(few_shortened(feature_names(info_.state_channels)));
    const std::string columns = counted(std::ssize(info_.state_channels), "column");
    if (!inputs_) {
      return fmt::format("{}: {}, as simulator.features or else target.observation says", columns,
                         names);
    }
    return fmt::format(
        "{}: {}, as simulator.states says, and {} for each simulation: the states of all segments, "
        "one after the other",
        columns, names, counted(inputs_->segments.num_steps(), "row"));
  }

  ExternalConfig external_;
  sim::SimulatorInfo info_;
  std::optional<ProgramInputs> inputs_;
  int threads_;
};

}  // namespace

std::unique_ptr<ProgramCall> make_file_call(const ExternalConfig& external,
                                            const sim::SimulatorInfo& info,
                                            const ProgramInputs* inputs, int threads) {
  return std::make_unique<FileCall>(external, info, inputs, threads);
}

}  // namespace npdr::pipeline
