#include "pipeline/stages/row_simulator.h"

#include <algorithm>

#include "pipeline/config/features.h"
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

class CommandRows final : public RowSimulator {
 public:
  CommandRows(const Study& study, const std::filesystem::path& log)
      : simulator_(std::make_unique<ExternalSimulator>(study.external, simulator_info(study), log)),
        rows_per_call_(study.simulate.shard_size) {}

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) const override {
    sim::Trajectories all =
        simulator_->simulate(complete.topRows(std::min(rows_per_call_, complete.rows())), first);
    while (all.num_rows < complete.rows()) {
      StreamId next = first;
      next.row += static_cast<std::uint64_t>(all.num_rows);
      const Index count = std::min(rows_per_call_, complete.rows() - all.num_rows);
      const sim::Trajectories more =
          simulator_->simulate(complete.middleRows(all.num_rows, count), next);
      all.num_rows += count;
      all.values.insert(all.values.end(), more.values.begin(), more.values.end());
      all.status.insert(all.status.end(), more.status.begin(), more.status.end());
    }
    return all;
  }

  std::string last_failure() const override { return simulator_->last_failure(); }

 private:
  std::unique_ptr<ExternalSimulator> simulator_;
  Index rows_per_call_;
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
