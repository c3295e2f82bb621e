#include "pipeline/stages/row_simulator.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/external/external_simulator.h"

namespace npdr::pipeline {
namespace {

class ReplayRows final : public RowSimulator {
 public:
  ReplayRows(const sim::SimulatorConfig& config, Target target)
      : simulator_(sim::make_simulator(config)), target_(std::move(target)) {}

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId&) const override {
    return simulator_->replay(target_, complete);
  }

 private:
  std::unique_ptr<sim::Simulator> simulator_;
  Target target_;
};

// Blocks of a shard's rows one after the other, each shared out among calls at the same time.
class CommandRows final : public RowSimulator {
 public:
  CommandRows(const Study& study, const std::filesystem::path& log)
      : rows_per_block_(study.simulate.shard_size) {
    const Index threads = num_threads(), wanted = study.external.parallel_calls;
    const Index calls = wanted == 0 ? threads : std::min(wanted, threads);
    for (Index c = 0; c < calls; ++c) {
      simulators_.push_back(std::make_unique<ExternalSimulator>(
          study.external, simulator_info(study), log_of_call(log, c),
          static_cast<int>(threads / calls)));
    }
  }

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) const override {
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
    if (call > 0) {
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

  std::vector<std::unique_ptr<ExternalSimulator>> simulators_;
  Index rows_per_block_;
};

}  // namespace

std::unique_ptr<RowSimulator> make_row_simulator(const Plan& plan,
                                                 const sim::SimulatorConfig& config,
                                                 const Target& target,
                                                 const std::filesystem::path& log) {
  if (plan.study.external.command) return std::make_unique<CommandRows>(plan.study, log);
  return std::make_unique<ReplayRows>(config, target);
}

std::filesystem::path log_of(const std::filesystem::path& artefact) {
  return std::filesystem::path(artefact).replace_extension(".log");
}

}  // namespace npdr::pipeline
