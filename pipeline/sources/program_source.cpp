#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "core/parallel.h"
#include "pipeline/sources/external_simulator.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

// Rows that a worker is asked for at once, a thread: few at first, then as many as take about as
// long as people like to wait for progress, or longer where more at once are faster, and as fit
// into memory when they cross the pipes.
constexpr Index kFirstRows = 16;
constexpr Index kMostRows = 4096;
constexpr double kSecondsPerRequest = 0.3, kMostSeconds = 3.0;
constexpr double kGain = 1.25;  // of rows a second, by twice as many rows
constexpr Index kMostNumbers = 1 << 23;

// Blocks of a shard's rows one after the other, each shared out among calls at the same time.
class ProgramRowSimulator final : public RowSimulator {
 public:
  // `files`: what rows may depend on.
  ProgramRowSimulator(const Study& study, const sim::SimulatorInfo& info, const RowsConfig& config,
                      std::vector<FileHashes> files)
      : files_(std::move(files)),
        stays_(study.source().kind == SourceKind::worker),
        rows_per_block_(study.simulate.shard_size),
        num_rows_(config.num_rows) {
    const Index threads = num_threads(), wanted = study.external.parallel_calls;
    const Index calls = wanted == 0 ? threads : std::min(wanted, threads);
    Program program{study.external, info, feature_segments(std::ssize(info.state_channels)), 1,
                    static_cast<int>(threads / calls)};
    if (program.gives_motion()) {
      program.segments = sim::cut(config.target, config.simulator.segment_length);
      program.store_every = config.simulator.store_every;
    }
    const Index hopeless =
        num_rows_ > 0 ? hopeless_rows(study.limits.max_failed_fraction) : kHopelessRows;
    for (Index c = 0; c < calls; ++c) {
      simulators_.push_back(
          std::make_unique<ExternalSimulator>(program, std::filesystem::path(), hopeless));
    }
    log_to(config.log);
  }

  void log_to(const std::filesystem::path& log) override {
    for (std::size_t c = 0; c < simulators_.size(); ++c) {
      std::filesystem::path of_call = log;
      if (c > 0 && !log.empty()) {
        of_call.replace_filename(fmt::format("{}-{}.log", log.stem().string(), c + 1));
      }
      simulators_[c]->log_to(of_call);
    }
  }

  // One call for all of a shard where starting it may cost more than its work.
  Index block_size(Index num_rows) const override {
    return stays_ ? rows_per_request_ * std::ssize(simulators_) : num_rows;
  }

  Index num_calls() const override { return std::ssize(simulators_); }

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) override {
    const auto start = Clock::now();
    sim::Trajectories all;
    for (Index begin = 0; begin < complete.rows(); begin += rows_per_block_) {
      const Index count = std::min(rows_per_block_, complete.rows() - begin);
      for (const sim::Trajectories& part : simulate_block(complete, begin, count, first)) {
        all.append(part);
      }
    }
    adapt(all, std::chrono::duration<double>(Clock::now() - start).count());
    for (FileHashes& files : files_) files.require_unchanged();
    return all;
  }

  std::string last_failure() const override {
    for (const auto words : {&ExternalSimulator::last_loss, &ExternalSimulator::lost_number,
                             &ExternalSimulator::last_failure}) {
      for (const auto& simulator : simulators_) {
        if (const std::string& found = ((*simulator).*words)(); !found.empty()) return found;
      }
    }
    return "";
  }

  Findings last_warnings() const override {
    for (const auto& simulator : simulators_) {
      if (!simulator->last_warnings().empty()) return simulator->last_warnings();
    }
    return {};
  }

 private:
  using Clock = std::chrono::steady_clock;

  // No result depends on it.
  void adapt(const sim::Trajectories& last, double seconds) {
    if (last.num_rows < block_size(0)) return;
    const double rate = static_cast<double>(last.num_rows) / seconds;
    const bool is_quick = seconds < 0.5 * kSecondsPerRequest;
    const bool pays = rate > kGain * rate_before_ && seconds < 0.5 * kMostSeconds;
    if (!is_quick && !pays) return;
    rate_before_ = rate;
    const Index fitting = std::max<Index>(1, kMostNumbers / std::max<Index>(1, last.row_size()));
    rows_per_request_ =
        std::max(rows_per_request_, std::min({2 * rows_per_request_, kMostRows, fitting}));
  }

  std::vector<sim::Trajectories> simulate_block(const RowMatrix& complete, Index begin, Index count,
                                                const StreamId& first) const {
    const Index calls = std::min(static_cast<Index>(simulators_.size()), count);
    // The time limit is for what a call has of a shard: all that a file's call is for, and more
    // than a worker is asked for at once.
    const Index most = std::min(rows_per_block_, num_rows_);
    const Index limited = stays_ ? (most + calls - 1) / calls : 0;
    std::vector<sim::Trajectories> parts(static_cast<std::size_t>(calls));
    parallel_for(calls, [&](Index c) {
      const Index from = begin + c * count / calls, to = begin + (c + 1) * count / calls;
      const auto i = static_cast<std::size_t>(c);
      parts[i] = simulators_[i]->simulate(complete.middleRows(from, to - from),
                                          row_after(first, from), limited);
    });
    return parts;
  }

  std::vector<FileHashes> files_;
  bool stays_;
  Index rows_per_block_;
  Index num_rows_;  // of the simulation; 0: not one
  Index rows_per_request_ = kFirstRows;
  double rate_before_ = 0.0;  // rows a second, of half as many
  std::vector<std::unique_ptr<ExternalSimulator>> simulators_;
};

class ProgramSource final : public Source {
 public:
  explicit ProgramSource(const Study& study)
      : Source(study),
        named_(named_paths(study.external.worker.value_or(study.external.command.value_or("")),
                           study.external.folder),
               study.external.folder),
        further_(study.external.files, study.external.folder) {}

  SourceKeys keys() const override {
    const ExternalConfig& external = study().external;
    Json json;
    json["files"] = named_.by_name();
    if (!external.files.empty()) json["further_files"] = further_.by_name();
    if (!traits().gives_motion) json["features"] = external.features;
    json.update(own_settings());
    json["parameters"] = study().simulator.parameters;
    for (const DescribedParameter& p : external.parameters) {
      const auto number = [](const std::optional<double>& v) { return v ? Json(*v) : Json(); };
      json["described"].push_back({p.name, number(p.nominal), number(p.lower), number(p.upper)});
    }
    return traits().gives_motion ? keys_of_motion(json)
                                 : SourceKeys{json, json, json, Json::object()};
  }

  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override {
    return std::make_unique<ProgramRowSimulator>(study(), info(), config,
                                                 std::vector{named_, further_});
  }

 private:
  FileHashes named_, further_;
};

}  // namespace

std::unique_ptr<Source> make_program_source(const Study& study) {
  return std::make_unique<ProgramSource>(study);
}

}  // namespace npdr::pipeline
