#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/feature_names.h"
#include "core/file_error.h"
#include "core/shell_call.h"
#include "core/temporary_folder.h"
#include "core/text.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/sources/first_rows.h"
#include "pipeline/sources/program_call.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {
namespace {

using sim::RolloutStatus;

// A shell's statuses for a program that isn't there or can't be run.
constexpr int kCannotRun = 126;
constexpr int kNotFound = 127;

// More than anybody reads, of the names of a call's failed rows, and of what is said of one.
constexpr std::uintmax_t kMostBytes = 1 << 24;
constexpr std::size_t kMostOfARow = 1000;

[[noreturn]] void reject_failed_rows(const std::string& why) {
  throw InputError("NPDR_FAILED " + why);
}

// Held while the files of a call are written and read: HDF5 serves one thread at a time.
std::unique_lock<std::mutex> lock_files(FileFormat format) {
  static std::mutex hdf5;
  return format == FileFormat::hdf5 ? std::unique_lock(hdf5) : std::unique_lock<std::mutex>();
}

// The files of one call. Names are absolute.
class CallFiles {
 public:
  explicit CallFiles(FileFormat format)
      : folder_("npdr-call", "calls of the simulator's command leave their files there"),
        format_(format) {}

  std::filesystem::path table(const std::string& name) const {
    return folder_.path() / (name + (format_ == FileFormat::csv ? ".csv" : ".h5"));
  }
  std::filesystem::path text(const std::string& name) const {
    return folder_.path() / (name + ".txt");
  }

  // CSV with the digits that give back the same doubles, or the dataset `name` with the attribute
  // `labels`.
  void write_table(const std::string& name, const std::vector<std::string>& labels,
                   const RowMatrix& values) const {
    if (format_ == FileFormat::csv) return write(table(name), csv(labels, values));
    h5::File file = h5::File::create(table(name));
    h5::Dataset dataset = file.write(name, values, {.chunked = false});
    dataset.set_attribute("labels", labels);
    file.close();
  }

  static void write(const std::filesystem::path& path, const std::string& text) {
    std::ofstream stream(path, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw_file_error(path, "write this file", errno);
  }

 private:
  static std::string csv(const std::vector<std::string>& labels, const RowMatrix& values) {
    fmt::memory_buffer text;
    fmt::format_to(std::back_inserter(text), "{}\n", fmt::join(labels, ","));
    for (Index i = 0; i < values.rows(); ++i) {
      fmt::format_to(std::back_inserter(text), "{}\n",
                     fmt::join(values.row(i).begin(), values.row(i).end(), ","));
    }
    return fmt::to_string(text);
  }

  TemporaryFolder folder_;
  FileFormat format_;
};

class FileCall final : public ProgramCall {
 public:
  explicit FileCall(const Program& program) : program_(program) {}

  ProgramReply call(const ProgramRows& rows) override {
    const CallFiles files(format());
    const ShellCall shell{prepare(rows, files), rows.time_limit};
    const CallResult ended = run_shell(shell);
    ProgramReply reply;
    reply.summary = ended.words(shell.time_limit);
    reply.output = ended.output;
    if (!ended.succeeded()) {
      reply.problem = reply.summary;
      reply.status = ended.timed_out ? RolloutStatus::timed_out : RolloutStatus::crashed;
      reply.cannot_run =
          !ended.timed_out && (ended.exit_status == kNotFound || ended.exit_status == kCannotRun);
      return reply;
    }
    try {
      read_result(files, rows.theta.rows(), reply);
    } catch (const InputError& error) {
      reply.status = RolloutStatus::bad_output;
      reply.problem = error.what();
    }
    return reply;
  }

 private:
  FileFormat format() const { return program_.external.format; }

  ShellCommand prepare(const ProgramRows& rows, const CallFiles& files) const {
    ShellCommand command = program_.shell_command(
        filled_command(*program_.external.command, files.table("theta"), files.table("x")));
    command.environment["NPDR_SEEDS"] = files.text("seeds");
    command.environment["NPDR_FAILED"] = files.text("failed");
    command.environment["NPDR_FIRST_ROW"] = std::to_string(rows.first_row);
    CallFiles::write(files.text("seeds"), fmt::format("{}\n", fmt::join(rows.seeds, "\n")));
    const std::unique_lock lock = lock_files(format());
    std::vector<std::string> names;
    for (const sim::Parameter& parameter : program_.info.parameters)
      names.push_back(parameter.name);
    files.write_table("theta", names, rows.theta);
    if (program_.gives_motion()) {
      write_segments(files);
      command.environment["NPDR_SEGMENTS"] = files.table("segments");
      command.environment["NPDR_ACTIONS"] = files.table("actions");
      command.environment["NPDR_DT"] = fmt::format("{}", program_.segments.dt);
    }
    return command;
  }

  // A row each segment: `steps`, `past` and its first state; a row each step: the actions.
  void write_segments(const CallFiles& files) const {
    const sim::Segments& segments = program_.segments;
    std::vector<std::string> names = {"steps", "past"};
    append(names, labels_of(program_.info.state_channels));
    RowMatrix rows(segments.num_segments(), 2 + segments.num_states());
    using Numbers = Eigen::Map<const VectorX<std::int64_t>>;
    rows << Numbers(segments.steps.data(), rows.rows()).cast<double>(),
        Numbers(segments.past.data(), rows.rows()).cast<double>(), segments.first_states;
    files.write_table("segments", names, rows);
    files.write_table("actions", labels_of(program_.info.action_channels), segments.actions);
  }

  // Throws InputError.
  void read_result(const CallFiles& files, Index num_rows, ProgramReply& reply) {
    const auto failed = read_failed_rows(files.text("failed"), num_rows);
    reply.row_status.assign(static_cast<std::size_t>(num_rows), RolloutStatus::ok);
    for (const auto& [row, why] : failed) {
      reply.row_status[static_cast<std::size_t>(row)] = RolloutStatus::crashed;
    }
    if (!failed.empty()) reply.problem = failed.rbegin()->second;
    if (std::ssize(failed) == num_rows) return;
    x_ = read_x(files, num_rows * program_.segments.num_steps());
    reply.states = {x_.data(), static_cast<std::size_t>(x_.size())};
    // Of motion the recording says it (first_rows.cpp).
    if (!program_.gives_motion()) {
      reply.warnings = find_lost_precision(x_, program_.info.state_channels);
    }
  }

  RowMatrix read_x(const CallFiles& files, Index num_lines) const {
    const std::unique_lock lock = lock_files(format());
    try {
      return read_features(files.table("x"), format(), num_lines,
                           {.features = program_.info.state_channels,
                            .names_from = program_.external.names_from,
                            .needs_line_ends = true})
          .x;
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}; x must have {}", error.what(), expected_columns()));
    }
  }

  std::string expected_columns() const {
    const std::vector<Channel>& channels = program_.info.state_channels;
    const std::string columns = fmt::format("{}: {}", counted(std::ssize(channels), "column"),
                                            join(few_shortened(feature_names(channels))));
    if (!program_.gives_motion()) {
      return columns + ", as simulator.features or else target.observation says";
    }
    return fmt::format(
        "{}, as simulator.states says, and {} for each simulation: the states of all segments, one "
        "after the other",
        columns, counted(program_.segments.num_steps(), "row"));
  }

  const Program& program_;
  RowMatrix x_;
};

}  // namespace

std::map<Index, std::string> read_failed_rows(const std::filesystem::path& path, Index num_rows) {
  std::map<Index, std::string> rows;
  std::error_code error;
  const auto type = std::filesystem::symlink_status(path, error).type();
  if (type == std::filesystem::file_type::not_found) return rows;
  if (type != std::filesystem::file_type::regular) reject_failed_rows("must be a file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kMostBytes) {
    reject_failed_rows(fmt::format(
        "has {} bytes, must have {} or less: a line for each row that failed", size, kMostBytes));
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) reject_failed_rows(fmt::format("can't be read: {}", std::strerror(errno)));
  Index number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    const std::size_t blank = std::min(line.find_first_of(" \t"), line.size());
    const std::optional<Index> row = parse_count(std::string_view(line).substr(0, blank));
    // A file that was cut may end in the middle of a number.
    const bool is_cut = stream.eof() && blank == line.size();
    if (!row || *row >= num_rows || is_cut) {
      reject_failed_rows(
          fmt::format("has in line {} {}, must have a row's number, 0 to {}, a blank, why it "
                      "failed, and the line's end",
                      number, npdr::quoted(line), num_rows - 1));
    }
    const std::string why = trimmed(line.substr(blank, kMostOfARow));
    rows.emplace(*row, why.empty() ? "it failed, and NPDR_FAILED doesn't say why" : why);
  }
  if (stream.bad()) reject_failed_rows("can't be read to its end");
  return rows;
}

std::unique_ptr<ProgramCall> make_file_call(const Program& program) {
  return std::make_unique<FileCall>(program);
}

}  // namespace npdr::pipeline
