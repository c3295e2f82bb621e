#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/atomic_file.h"
#include "core/stop_request.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/checkpoints.h"
#include "pipeline/stages/refined_rows.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Between two looks at what is asked for: short as long as the refinement may only be fitting its
// next proposal, since looking through a folder asks the server of a network file system.
void pause(double idle_seconds) {
  constexpr double shortest = 0.05, longest = 1.0;  // [s]
  const double length = std::clamp(0.1 * idle_seconds, shortest, longest);
  const auto end = Clock::now() + std::chrono::duration<double>(length);
  while (Clock::now() < end && !stop_requested()) {
    std::this_thread::sleep_for(std::chrono::duration<double>(shortest));
  }
}

// Beside that of the refinement: programs of both write at the same time.
std::filesystem::path helper_log(const Node& node, const Helper& helper) {
  return std::filesystem::path(node.path).replace_extension(
      fmt::format("helper-{}.log", helper.number));
}

// It may begin together with the run that makes them.
void wait_for_inputs(const Plan& plan, const Node& node, double patience) {
  const auto start = Clock::now();
  double waited = 0.0;
  while (!has_inputs(plan, node) && waited < patience) {
    if (waited == 0.0) report_error("help " + node.label(), "waits for what it starts from");
    pause(waited);
    stop_here_if_requested();
    waited = seconds_since(start);
  }
  require_inputs(plan, node);
}

}  // namespace

Index help_refinement(const Plan& plan, const Node& node, const Helper& helper, double patience) {
  wait_for_inputs(plan, node, patience);
  SimulatedLikelihood likelihood(plan, node, helper_log(node, helper));
  RefinedRows rows(plan, node, likelihood, helper);
  Progress progress(fmt::format("help {}, simulations", node.label()), 0);
  make_folder(plan.work.asked_rows(node.key));
  Index num_rows = 0;
  auto last = Clock::now();
  while (!is_complete(plan, node)) {
    stop_here_if_requested();
    const Index made = rows.help([](Index) {});
    num_rows += made;
    progress.update(num_rows);
    if (made > 0) last = Clock::now();
    const double idle = seconds_since(last);
    if (idle >= patience) {
      report_error("help " + node.label(),
                   fmt::format("nothing was asked for in {:.0f} s, so this helper ends; the same "
                               "command, or 'npdr submit', begins another",
                               patience));
      break;
    }
    if (made == 0) pause(idle);
  }
  return num_rows;
}

}  // namespace npdr::pipeline
