#include "pipeline/features/failures.h"

#include <fmt/format.h>

#include <cmath>

#include "inference/diagnostics/uniformity.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/plan/completeness.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {
namespace {

FailureResult test_simulation(const Plan& plan, const Node& simulation) {
  const Use& use = simulation.uses.front();
  const h5::File file = open_artefact(simulation, kSimulationSchema);
  FailureResult result{.round = use.round, .parameter = "", .other = "", .test = {}};
  if (file.attribute<Index>("num_failed") == 0) return result;
  const auto status = file.dataset("status").read<std::uint8_t>();
  const RowMatrix theta =
      file.read_matrix<double>("theta", std::ssize(status), -1, h5::Values::finite);
  std::vector<std::uint32_t> rows;
  std::vector<bool> failed;
  for (std::size_t i = 0; i < status.size(); ++i) {
    const auto end = static_cast<sim::RolloutStatus>(status[i]);
    if (end == sim::RolloutStatus::out_of_limits) continue;
    rows.push_back(static_cast<std::uint32_t>(i));
    failed.push_back(end != sim::RolloutStatus::ok);
  }
  const inference::Prior prior(plan.study.prior);
  result.test =
      inference::test_failures(prior.to_normal(theta(rows, Eigen::all)), failed,
                               {use.seed, "failures", static_cast<std::uint64_t>(use.round), 0, 0});
  const auto [first, second] = result.test.term;
  const auto name = [&](Index d) {
    return d < 0 ? "" : plan.study.prior[static_cast<std::size_t>(d)].name;
  };
  result.parameter = name(first);
  result.other = name(second);
  return result;
}

std::string difference_of(const FailureResult& found) {
  const inference::FailureDependence& test = found.test;
  if (found.other.empty()) {
    return fmt::format("their '{}' is {:.2g} deviations {} that of the others", found.parameter,
                       std::abs(test.shift), test.shift > 0.0 ? "above" : "below");
  }
  if (found.other == found.parameter) {
    return fmt::format("their '{}' lies {} of the others", found.parameter,
                       test.shift > 0.0 ? "at both ends of that" : "in the middle of that");
  }
  return fmt::format("their '{}' and '{}' go together otherwise than those of the others",
                     found.parameter, found.other);
}

}  // namespace

FailureResult test_failures(const Plan& plan, const std::vector<const Node*>& simulations) {
  FailureResult clearest;
  Index num_tested = 0;
  for (const Node* simulation : simulations) {
    const FailureResult found = test_simulation(plan, *simulation);
    if (found.test.num_failed == 0) continue;
    if (num_tested++ == 0 || found.test.p_value < clearest.test.p_value) clearest = found;
  }
  if (num_tested > 0) {
    clearest.test.p_value = inference::corrected(clearest.test.p_value, num_tested);
  }
  return clearest;
}

std::string words_of(const FailureResult& found) {
  return fmt::format("{} of {} simulations of round {} failed; {}", found.test.num_failed,
                     found.test.num_failed + found.test.num_good, found.round,
                     difference_of(found));
}

std::string where_failures_lie(const Plan& plan, const Node& simulation) {
  constexpr double level = 0.001;
  const FailureResult found = test_simulation(plan, simulation);
  return found.test.num_failed > 0 && found.test.p_value < level ? difference_of(found) : "";
}

}  // namespace npdr::pipeline
