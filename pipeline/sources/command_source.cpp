#include "pipeline/sources/command_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/parallel.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/sources/command_text.h"
#include "pipeline/sources/external_simulator.h"

namespace npdr::pipeline {
namespace {

// Blocks of a shard's rows one after the other, each shared out among calls at the same time.
class CommandRows final : public RowSimulator {
 public:
  CommandRows(const Study& study, const sim::SimulatorInfo& info, const std::filesystem::path& log)
      : external_(study.external), info_(info), rows_per_block_(study.simulate.shard_size) {
    log_to(log);
  }

  void log_to(const std::filesystem::path& log) override {
    simulators_.clear();
    const Index threads = num_threads(), wanted = external_.parallel_calls;
    const Index calls = wanted == 0 ? threads : std::min(wanted, threads);
    for (Index c = 0; c < calls; ++c) {
      simulators_.push_back(std::make_unique<ExternalSimulator>(
          external_, info_, log_of_call(log, c), static_cast<int>(threads / calls)));
    }
  }

  // One call for all of a shard: starting it may cost more than its work.
  Index block_size(Index num_rows) const override { return num_rows; }

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) override {
    sim::Trajectories all;
    for (Index begin = 0; begin < complete.rows(); begin += rows_per_block_) {
      const Index count = std::min(rows_per_block_, complete.rows() - begin);
      for (const sim::Trajectories& part : simulate_block(complete, begin, count, first)) {
        append(part, all);
      }
    }
    return all;
  }

  std::string last_failure() const override {
    for (const auto& simulator : simulators_) {
      if (!simulator->last_failure().empty()) return simulator->last_failure();
    }
    return "";
  }

 private:
  static std::filesystem::path log_of_call(std::filesystem::path log, Index call) {
    if (call > 0 && !log.empty()) {
      log.replace_filename(fmt::format("{}-{}.log", log.stem().string(), call + 1));
    }
    return log;
  }

  std::vector<sim::Trajectories> simulate_block(const RowMatrix& complete, Index begin, Index count,
                                                const StreamId& first) const {
    const Index calls = std::min(static_cast<Index>(simulators_.size()), count);
    std::vector<sim::Trajectories> parts(static_cast<std::size_t>(calls));
    parallel_for(calls, [&](Index c) {
      const Index from = begin + c * count / calls, to = begin + (c + 1) * count / calls;
      StreamId id = first;
      id.row += static_cast<std::uint64_t>(from);
      const auto i = static_cast<std::size_t>(c);
      parts[i] = simulators_[i]->simulate(complete.middleRows(from, to - from), id);
    });
    return parts;
  }

  static void append(const sim::Trajectories& part, sim::Trajectories& all) {
    if (all.num_rows == 0) {
      all = part;
      return;
    }
    all.num_rows += part.num_rows;
    all.values.insert(all.values.end(), part.values.begin(), part.values.end());
    all.status.insert(all.status.end(), part.status.begin(), part.status.end());
  }

  ExternalConfig external_;
  sim::SimulatorInfo info_;
  Index rows_per_block_;
  std::vector<std::unique_ptr<ExternalSimulator>> simulators_;
};

}  // namespace

SourceKeys CommandSource::keys() const {
  const ExternalConfig& external = study().external;
  const nlohmann::ordered_json json = {{"files", named_files(*external.command, external.folder)},
                                       {"features", external.features},
                                       {"command", *external.command},
                                       {"format", name_of(external.format)},
                                       {"time_limit", external.time_limit},
                                       {"start_time", external.start_time},
                                       {"retries", external.retries},
                                       {"parameters", study().simulator.parameters}};
  return {json, json, json, nlohmann::ordered_json::object()};
}

std::unique_ptr<RowSimulator> CommandSource::open(const RowsConfig& config) const {
  return std::make_unique<CommandRows>(study(), info(), config.log);
}

Target CommandSource::behave(const std::filesystem::path& log) const {
  const TargetConfig& target = study().target;
  CommandRows rows(study(), info(), log);
  const sim::Trajectories x = rows.simulate(parameters().nominal(*target.truth).transpose(),
                                            {target.seed, "external_truth", 0, 0, 0});
  if (x.status.front() == sim::RolloutStatus::ok) {
    return observation_target(info().state_channels,
                              x.rollout(0, 0).row(0).cast<double>().transpose(),
                              "simulated at the truth");
  }
  throw Error(fmt::format("target.truth: simulator.command = '{}' gives no x_o there ({}): {}",
                          *study().external.command, sim::to_string(x.status.front()),
                          rows.last_failure()));
}

}  // namespace npdr::pipeline
