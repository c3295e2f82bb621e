#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/process/worker_process.h"
#include "pipeline/sources/program_call.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/hostile_json.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using sim::RolloutStatus;

static_assert(std::endian::native == std::endian::little, "arrays are sent as they are");

constexpr int kProtocol = 1;

// Time that a program may take to load before it answers, at least.
constexpr double kStartSeconds = 60.0;

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
  namespace fs = std::filesystem;
  constexpr std::size_t most = 20;
  std::error_code error;
  const auto real = [&](const fs::path& path) {
    return fs::weakly_canonical(fs::path(external.folder) / path, error);
  };
  std::set<fs::path> named;
  for (const std::string& name : external.files) named.insert(real(name));
  for (const std::string& word : named_paths(*external.worker, external.folder)) {
    named.insert(real(word));
  }
  std::vector<std::string> unnamed;
  for (const Json& file : hello.value("files", Json::array())) {
    if (!file.is_string()) continue;
    const fs::path path = real(file.get<std::string>());
    if (named.contains(path) || !fs::is_regular_file(path, error)) continue;
    unnamed.push_back(quoted(path.lexically_proximate(real("")).string()));
  }
  if (unnamed.empty()) return {};
  if (unnamed.size() > most) {
    unnamed.resize(most);
    unnamed.emplace_back("...");
  }
  return {warning(fmt::format(
      "the worker imports files that the study doesn't name: when they are edited, nothing is "
      "simulated again; add simulator.files = [{}]",
      join(unnamed)))};
}

// Statuses that a program may give; another is none of a row's.
RolloutStatus row_status(char byte) {
  const auto given = static_cast<RolloutStatus>(byte);
  constexpr std::array allowed = {RolloutStatus::ok, RolloutStatus::diverged,
                                  RolloutStatus::out_of_limits, RolloutStatus::left_scene};
  return std::ranges::find(allowed, given) != allowed.end() ? given : RolloutStatus::crashed;
}

class WorkerCall final : public ProgramCall {
 public:
  explicit WorkerCall(const Program& program)
      : program_(program), start_limit_(std::max(kStartSeconds, program.external.start_time)) {}

  ProgramReply call(const ProgramRows& rows) override {
    if (!worker_) {
      if (auto failure = start()) return *failure;
    }
    const Index n = rows.theta.rows();
    std::string message;
    const WorkerReply given = worker_->exchange(
        request(rows), rows.time_limit,
        [&](const std::string& header) { return read_header(header, n, message); }, body_);
    ProgramReply reply = as_reply(given);
    reply.warnings = warnings_;
    if (reply.succeeded()) {
      reply.problem = message;
      if (body_.empty()) {
        reply.status = RolloutStatus::crashed;
      } else {
        take(n, reply);
      }
    }
    reply.summary =
        fmt::format("{} after {:.3g} s", reply.problem.empty() ? "done" : "failed", given.seconds);
    return reply;
  }

 private:
  // Without rows. A program that has failed is ended: nobody knows what it would say next.
  ProgramReply as_reply(const WorkerReply& given) {
    ProgramReply reply;
    reply.output = worker_->take_output();
    reply.problem = given.problem;
    if (given.problem.empty()) return reply;
    reply.status = given.timed_out   ? RolloutStatus::timed_out
                   : given.has_ended ? RolloutStatus::crashed
                                     : RolloutStatus::bad_output;
    worker_.reset();
    return reply;
  }

  // Starts the program and waits until it answers; the failure, if it doesn't.
  std::optional<ProgramReply> start() {
    worker_.emplace(program_.shell_command(*program_.external.worker));
    const std::string line = Json({{"npdr_worker", kProtocol}, {"request", "hello"}}).dump() + "\n";
    const WorkerReply given = worker_->exchange(
        line, start_limit_,
        [&](const std::string& header) -> std::size_t {
          const Json hello = parse_header(header);
          if (hello.value("reply", Json()) != "hello") throw InputError("must be \"hello\"");
          warnings_ = unnamed_imports(hello, program_.external);
          return 0;
        },
        body_);
    if (given.problem.empty()) return std::nullopt;
    ProgramReply reply = as_reply(given);
    reply.cannot_run = true;
    if (given.has_ended && given.exit_status == 0) {
      reply.problem += ", before it answered: does it call npdr_worker.serve()?";
    }
    if (given.timed_out) {
      reply.problem = fmt::format(
          "no answer within {:.3g} s of its start: where it needs longer until it calls "
          "npdr_worker.serve(), raise simulator.start_time",
          start_limit_);
    }
    reply.summary = fmt::format("not started after {:.3g} s", given.seconds);
    return reply;
  }

  std::vector<char> request(const ProgramRows& rows) const {
    const sim::Segments& s = program_.segments;
    std::vector<std::string> parameters;
    for (const sim::Parameter& parameter : program_.info.parameters) {
      parameters.push_back(parameter.name);
    }
    Json header = {{"npdr_worker", kProtocol},
                   {"request", "replay"},
                   {"first_row", rows.first_row},
                   {"dt", s.dt},
                   {"parameters", parameters},
                   {"states", labels_of(program_.info.state_channels)},
                   {"actions", labels_of(program_.info.action_channels)},
                   {"arrays", Json::array()}};
    std::vector<char> body;
    const auto add = [&](const char* name, const char* type, const std::vector<Index>& shape,
                         const auto& values) {
      header["arrays"].push_back({{"name", name}, {"type", type}, {"shape", shape}});
      const auto* const begin = reinterpret_cast<const char*>(values.data());
      body.insert(body.end(), begin,
                  begin + std::ssize(values) * std::ptrdiff_t{sizeof(*values.data())});
    };
    const auto add_matrix = [&](const char* name, const RowMatrix& values) {
      add(name, "<f8", {values.rows(), values.cols()}, values);
    };
    add_matrix("theta", rows.theta);
    add("seeds", "<u4", {rows.theta.rows()}, rows.seeds);
    add("steps", "<i8", {s.num_segments()}, s.steps);
    add("past", "<i8", {s.num_segments()}, s.past);
    add_matrix("first_states", s.first_states);
    add_matrix("actions", s.actions);
    const std::string line = header.dump() + "\n";
    body.insert(body.begin(), line.begin(), line.end());
    return body;
  }

  // The size of what follows the header: states (n, N, C), then status (n). `message`: of a worker
  // that couldn't, or of rows that failed.
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
    const sim::Segments& s = program_.segments;
    const Json expected = {n, s.num_steps(), s.num_states()};
    if (reply != "states" || json.value("shape", Json()) != expected) {
      throw InputError(fmt::format(
          "reply = {} of shape {}, must be \"states\" of shape {}: rows, steps of all segments, "
          "state channels",
          shortened(reply.dump()), shortened(json.value("shape", Json()).dump()), expected.dump()));
    }
    return static_cast<std::size_t>(n) + sizeof(double) * num_numbers(n);
  }

  std::size_t num_numbers(Index n) const {
    return static_cast<std::size_t>(n * program_.segments.num_steps() *
                                    program_.segments.num_states());
  }

  void take(Index n, ProgramReply& reply) const {
    const std::size_t size = num_numbers(n);
    reply.states = {reinterpret_cast<const double*>(body_.data()), size};  // new aligns it
    std::transform(body_.begin() + static_cast<std::ptrdiff_t>(size * sizeof(double)), body_.end(),
                   std::back_inserter(reply.row_status), row_status);
  }

  const Program& program_;
  double start_limit_;  // [s]
  Findings warnings_;   // about the program, since it has started
  std::optional<WorkerProcess> worker_;
  std::vector<char> body_;
};

}  // namespace

std::unique_ptr<ProgramCall> make_worker_call(const Program& program) {
  return std::make_unique<WorkerCall>(program);
}

}  // namespace npdr::pipeline
