#include "pipeline/plan/completeness.h"

#include <unistd.h>

#include <algorithm>

#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/process/batch_job.h"

namespace npdr::pipeline {

bool is_complete(const Plan& plan, const Node& node) {
  if (node.stage == Stage::report) return report_is_current(plan, node);
  const std::filesystem::file_status there = std::filesystem::status(node.path);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) {
    const char* const kind =
        std::filesystem::is_directory(there) ? "a folder" : "a device, pipe or socket";
    throw InputError(node.path.string() + ": is " + kind + ", must be a file; move it away");
  }
  return std::filesystem::exists(there);
}

bool has_inputs(const Plan& plan, const Node& node) {
  return std::ranges::all_of(node.needs,
                             [&](std::size_t need) { return is_complete(plan, plan.nodes[need]); });
}

namespace {

// A helper that settles at the same time takes files away that are about to be removed, which ends
// an attempt.
void remove_with_others(const std::filesystem::path& folder) {
  constexpr int most_attempts = 100;
  std::error_code ignored;
  for (int i = 0; i < most_attempts && std::filesystem::exists(folder, ignored); ++i) {
    std::filesystem::remove_all(folder, ignored);
  }
}

}  // namespace

void settle(const Plan& plan, const Node& node) {
  link_uses(plan, node);
  std::error_code ignored;
  std::filesystem::remove(plan.work.checkpoint(name_of(node.stage), node.key), ignored);
  if (is_refinement(plan, node)) {
    remove_with_others(plan.work.asked_rows(node.key));
  }
}

namespace {

// On a network file system a machine may not see for a while what another one has just made, and
// a batch job begins at that very moment. Looking through the folder asks the server.
bool appears(const Plan& plan, const Node& input) {
  constexpr int patience = 60;  // [s]
  for (int second = 0; second < patience && !batch_job_id().empty(); ++second) {
    std::error_code ignored;
    for (std::filesystem::directory_iterator entry(input.path.parent_path(), ignored), end;
         !ignored && entry != end; entry.increment(ignored)) {
    }
    if (is_complete(plan, input)) return true;
    if (stop_requested()) return false;
    sleep(1);
  }
  return is_complete(plan, input);
}

}  // namespace

void require_input(const Plan& plan, const Node& node, const Node& input) {
  if (is_complete(plan, input) || appears(plan, input)) return;
  throw InputError(node.label() + " needs '" + input.label() + "', which isn't there; run " +
                   std::string(traits_of(input.stage).program) +
                   " on this study first, or npdr run");
}

void require_inputs(const Plan& plan, const Node& node) {
  for (const std::size_t i : node.needs) require_input(plan, node, plan.nodes[i]);
}

}  // namespace npdr::pipeline
