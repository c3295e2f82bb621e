#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/process/worker_process.h"
#include "pipeline/sources/command_text.h"
#include "pipeline/sources/program_call.h"
#include "pipeline/sources/python_path.h"
#include "pipeline/store/hostile_json.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using sim::RolloutStatus;

static_assert(std::endian::native == std::endian::little, "arrays are sent as they are");

constexpr int kProtocol = 1;

// Time that a program may take to load before it answers, at least.
constexpr double kStartSeconds = 60.0;

// Arrays of a message, and the header that says what they are.
class Message {
 public:
  explicit Message(Json header) : header_(std::move(header)) { header_["arrays"] = Json::array(); }

  template <class T>
  void add(const char* name, const char* type, const std::vector<Index>& shape, const T* values) {
    header_["arrays"].push_back({{"name", name}, {"type", type}, {"shape", shape}});
    std::size_t size = sizeof(T);
    for (const Index n : shape) size *= static_cast<std::size_t>(n);
    const std::size_t begin = body_.size();
    body_.resize(begin + size);
    if (size > 0) std::memcpy(body_.data() + begin, values, size);
  }

  std::vector<char> bytes() const {
    const std::string line = header_.dump() + "\n";
    std::vector<char> all(line.begin(), line.end());
    all.insert(all.end(), body_.begin(), body_.end());
    return all;
  }

 private:
  Json header_;
  std::vector<char> body_;
};

std::vector<std::string> labels_of(const std::vector<Channel>& channels) {
  std::vector<std::string> labels;
  for (const Channel& channel : channels) labels.push_back(channel.label);
  return labels;
}

Json parse_header(const std::string& header) {
  Json json = json_in(header).value_or(Json());
  if (!json.is_object() || !json.contains("npdr_worker")) {
    throw InputError("it printed " + quoted(shortened(header)) +
                     "; what is for people belongs on standard error");
  }
  if (json["npdr_worker"] != kProtocol) {
    throw InputError(fmt::format("npdr_worker = {}, must be {}",
                                 shortened(json["npdr_worker"].dump()), kProtocol));
  }
  return json;
}

// What the program has imported of its folder, by its own words, and the study doesn't name.
Findings unnamed_imports(const Json& hello, const ExternalConfig& external) {
  constexpr std::size_t most = 20;
  std::error_code error;
  const auto real = [&](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::path(external.folder) / path, error);
  };
  std::set<std::filesystem::path> named;
  for (const std::string& name : external.files) named.insert(real(name));
  for (const std::string& word : named_paths(*external.worker, external.folder)) {
    named.insert(real(word));
  }
  const std::filesystem::path folder = real("");
  std::vector<std::string> unnamed;
  for (const Json& file : hello.value("files", Json::array())) {
    if (!file.is_string()) continue;
    const std::filesystem::path path = real(file.get<std::string>());
    if (named.contains(path) || !std::filesystem::is_regular_file(path, error)) continue;
    unnamed.push_back(quoted(path.lexically_proximate(folder).string()));
  }
  if (unnamed.empty()) return {};
  if (unnamed.size() > most) {
    unnamed.resize(most);
    unnamed.emplace_back("...");
  }
  return {warning(fmt::format(
      "the worker imports {}, which the study doesn't name: when edited, nothing is simulated "
      "again; add simulator.files = [{}]",
      join(unnamed), join(unnamed)))};
}

class WorkerCall final : public ProgramCall {
 public:
  WorkerCall(const ExternalConfig& external, sim::SimulatorInfo info, ProgramInputs inputs,
             int threads)
      : external_(external),
        command_{*external.worker,
                 external.folder,
                 {{"PYTHONPATH", python_path()}, {"OMP_NUM_THREADS", std::to_string(threads)}}},
        start_limit_(std::max(kStartSeconds, external.start_time)),
        info_(std::move(info)),
        inputs_(std::move(inputs)) {}

  ProgramOutcome call(const ProgramRows& rows, sim::Trajectories& result) override {
    if (!worker_) {
      if (auto failure = start()) return *failure;
    }
    const Index n = rows.theta.rows();
    std::string message;
    const WorkerReply reply = worker_->exchange(
        request(rows), rows.time_limit,
        [&](const std::string& header) { return read_header(header, n, message); }, body_);
    ProgramOutcome outcome;
    outcome.output = worker_->take_output();
    outcome.warnings = warnings_;
    outcome.problem = reply.problem.empty() ? message : reply.problem;
    if (!reply.problem.empty()) {
      outcome.succeeded = false;
      outcome.status = reply.timed_out   ? RolloutStatus::timed_out
                       : reply.has_ended ? RolloutStatus::crashed
                                         : RolloutStatus::bad_output;
      worker_.reset();  // nobody knows what it would say next
    } else if (body_.empty() && n > 0) {
      outcome.succeeded = false;
      outcome.status = RolloutStatus::crashed;
    } else {
      take(n, result);
      outcome.lost = lost_number(result);
    }
    outcome.summary = fmt::format("{} after {:.3g} s", outcome.problem.empty() ? "done" : "failed",
                                  reply.seconds);
    return outcome;
  }

  sim::Trajectories empty(Index num_rows) const override {
    return sim::empty_trajectories(inputs_.segments, num_rows, inputs_.store_every);
  }

  std::string words() const override {
    return fmt::format("simulator.worker = '{}'", command_.text);
  }

 private:
  // Starts the program and waits until it answers; the failure, if it doesn't.
  std::optional<ProgramOutcome> start() {
    worker_.emplace(command_);
    const std::string line = Json({{"npdr_worker", kProtocol}, {"request", "hello"}}).dump() + "\n";
    const WorkerReply reply = worker_->exchange(
        line, start_limit_,
        [&](const std::string& header) -> std::size_t {
          const Json hello = parse_header(header);
          if (hello.value("reply", Json()) != "hello") throw InputError("must be \"hello\"");
          warnings_ = unnamed_imports(hello, external_);
          return 0;
        },
        body_);
    if (reply.problem.empty()) return std::nullopt;
    ProgramOutcome outcome;
    outcome.succeeded = false;
    outcome.cannot_run = true;
    outcome.problem = reply.problem;
    if (reply.has_ended && reply.exit_status == 0)
      outcome.problem += ", before it answered: does it call npdr_worker.serve()?";
    if (reply.timed_out)
      outcome.problem = fmt::format(
          "no answer within {:.3g} s of its start: where it needs longer until it calls "
          "npdr_worker.serve(), raise simulator.start_time",
          start_limit_);
    outcome.summary = fmt::format("not started after {:.3g} s", reply.seconds);
    outcome.output = worker_->take_output();
    worker_.reset();
    return outcome;
  }

  std::vector<char> request(const ProgramRows& rows) const {
    const sim::Segments& s = inputs_.segments;
    const Index n = rows.theta.rows(), segments = s.num_segments();
    std::vector<std::string> parameters;
    for (const sim::Parameter& parameter : info_.parameters) parameters.push_back(parameter.name);
    Message message({{"npdr_worker", kProtocol},
                     {"request", "replay"},
                     {"first_row", rows.first_row},
                     {"dt", s.dt},
                     {"parameters", parameters},
                     {"states", labels_of(info_.state_channels)},
                     {"actions", labels_of(info_.action_channels)}});
    message.add("theta", "<f8", {n, rows.theta.cols()}, rows.theta.data());
    message.add("seeds", "<u4", {n}, rows.seeds.data());
    message.add("steps", "<i8", {segments}, s.steps.data());
    message.add("past", "<i8", {segments}, s.past.data());
    message.add("first_states", "<f8", {segments, s.num_states()}, s.first_states.data());
    message.add("actions", "<f8", {s.num_steps(), s.actions.cols()}, s.actions.data());
    return message.bytes();
  }

  std::size_t body_size(Index n) const {
    return static_cast<std::size_t>(n) *
           (1 + sizeof(double) * static_cast<std::size_t>(num_numbers()));
  }

  // The size of what follows the header. `message`: of a worker that couldn't, or of rows that
  // failed.
  std::size_t read_header(const std::string& header, Index n, std::string& message) const {
    const Json json = parse_header(header);
    if (json.contains("message") && json["message"].is_string()) {
      message = json["message"].get<std::string>();
    }
    const Json reply = json.value("reply", Json());
    if (reply == "error") {
      if (message.empty()) message = "it failed without saying why";
      return 0;
    }
    const Json expected = {n, inputs_.segments.num_steps(), inputs_.segments.num_states()};
    if (reply != "states" || json.value("shape", Json()) != expected) {
      throw InputError(fmt::format(
          "reply = {} of shape {}, must be \"states\" of shape {}: rows, steps of all segments, "
          "state channels",
          shortened(reply.dump()), shortened(json.value("shape", Json()).dump()), expected.dump()));
    }
    return body_size(n);
  }

  std::optional<LostNumber> lost_number(const sim::Trajectories& result) const {
    const auto size = static_cast<std::size_t>(result.num_rows * num_numbers());
    return first_lost_number({states(), size}, result, info_.state_channels,
                             inputs_.segments.num_steps() / inputs_.segments.num_rollouts);
  }

  // Of a row.
  Index num_numbers() const { return inputs_.segments.num_steps() * inputs_.segments.num_states(); }
  // (n, N, C), then status (n); new aligns it.
  const double* states() const { return reinterpret_cast<const double*>(body_.data()); }

  void take(Index n, sim::Trajectories& result) {
    const Index row_size = num_numbers();
    const auto* const ends = body_.data() + static_cast<std::size_t>(n * row_size) * sizeof(double);
    for (Index i = 0; i < n; ++i) {
      const auto status = static_cast<std::uint8_t>(ends[i]);
      if (status == static_cast<std::uint8_t>(RolloutStatus::ok)) {
        sim::store_states(inputs_.segments, states() + i * row_size, inputs_.store_every, i,
                          result);
      } else {
        sim::lose_row(i, status_of(status), result);
      }
    }
  }

  // Takes those that a program may give; another is none of a row's.
  static RolloutStatus status_of(std::uint8_t status) {
    const auto given = static_cast<RolloutStatus>(status);
    return given == RolloutStatus::diverged || given == RolloutStatus::out_of_limits ||
                   given == RolloutStatus::left_scene
               ? given
               : RolloutStatus::crashed;
  }

  ExternalConfig external_;
  ShellCommand command_;
  Findings warnings_;   // about the program, since it has started
  double start_limit_;  // [s]
  sim::SimulatorInfo info_;
  ProgramInputs inputs_;
  std::optional<WorkerProcess> worker_;
  std::vector<char> body_;
};

}  // namespace

std::unique_ptr<ProgramCall> make_worker_call(const ExternalConfig& external,
                                              const sim::SimulatorInfo& info,
                                              const ProgramInputs& inputs, int threads) {
  return std::make_unique<WorkerCall>(external, info, inputs, threads);
}

}  // namespace npdr::pipeline
