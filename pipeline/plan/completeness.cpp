#include "pipeline/plan/completeness.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "core/error.h"
#include "core/stop_request.h"
#include "core/text.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
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

std::vector<UsedNode> last_nodes(const Plan& plan, Stage stage,
                                 const std::vector<std::string>& methods) {
  std::vector<UsedNode> found;
  for (const Node& node : plan.nodes) {
    if (node.stage != stage) continue;
    for (const Use& use : node.uses) {
      const MethodConfig& method = plan.study.method(use.method);
      const Index iteration = use.iteration > 0 ? plan.study.num_iterations_of(method) : 0;
      const bool is_last =
          use.round == method.algorithm.num_rounds && use.iteration == iteration && use.fold == 0;
      const bool is_wanted = methods.empty() || std::ranges::count(methods, use.method) > 0;
      if (is_last && is_wanted) found.push_back({&node, use});
    }
  }
  return found;
}

std::vector<UsedNode> last_nodes_of_method(const Plan& plan, Stage stage,
                                           const std::vector<std::string>& methods) {
  std::vector<UsedNode> found = last_nodes(plan, stage, methods);
  std::vector<std::string> names;
  const auto note_names = [&] {
    names.clear();
    for (const auto& [node, use] : found) {
      if (std::ranges::count(names, use.method) == 0) names.push_back(use.method);
    }
  };
  note_names();
  // The fit that a study has by itself is meant only where nothing else is there.
  if (const MethodConfig* fit = plan.study.floor_method(); fit && names.size() == 2) {
    std::erase_if(found, [&](const UsedNode& each) { return each.use.method == fit->name; });
    note_names();
  }
  if (names.size() != 1) {
    throw InputError(
        fmt::format("{}: {} methods have posteriors ({}), must be one: choose it by "
                    "--method",
                    plan.study.name, names.size(), join(names)));
  }
  for (const auto& [node, use] : found) {
    if (is_complete(plan, *node)) continue;
    throw InputError(node->label() + ": isn't there yet; run it first: " + plan.command());
  }
  return found;
}

void settle(const Plan& plan, const Node& node) {
  link_uses(plan, node);
  std::error_code ignored;
  std::filesystem::remove(plan.work.checkpoint(name_of(node.stage), node.key), ignored);
  if (!is_refinement(plan, node)) return;
  // A helper that settles at the same time takes files away that are about to be removed, which
  // ends an attempt.
  constexpr int most_attempts = 100;
  const std::filesystem::path folder = plan.work.asked_rows(node.key);
  for (int i = 0; i < most_attempts && std::filesystem::exists(folder, ignored); ++i) {
    std::filesystem::remove_all(folder, ignored);
  }
}

void require_input(const Plan& plan, const Node& node, const Node& input) {
  if (is_complete(plan, input) || appears(plan, input)) return;
  throw InputError(node.label() + " needs '" + input.label() + "', which isn't there; run " +
                   std::string(traits_of(input.stage).program) +
                   " on this study first, or npdr run");
}

void require_inputs(const Plan& plan, const Node& node) {
  for (const std::size_t i : node.needs) require_input(plan, node, plan.nodes[i]);
}

std::vector<Shard> shards(const Plan& plan, const Node& node) {
  std::vector<Shard> all;
  const Index n = num_rows(plan, node);
  const Index size = plan.study.simulate.shard_size;
  for (Index begin = 0; begin < n; begin += size) {
    const RowRange rows{begin, std::min(begin + size, n)};
    all.push_back({rows, plan.work.shard(node.key, rows)});
  }
  return all;
}

Index num_shards(const Plan& plan, const Node& node) {
  const Index size = plan.study.simulate.shard_size;
  return (num_rows(plan, node) + size - 1) / size;
}

std::vector<Index> missing_shards(const Plan& plan, const Node& node) {
  std::vector<Index> missing;
  Index number = 0;
  for (const Shard& shard : shards(plan, node)) {
    if (!std::filesystem::exists(shard.path)) missing.push_back(number);
    ++number;
  }
  return missing;
}

void require_shard(const Plan& plan, const Node& node, Index number) {
  const Index count = num_shards(plan, node);
  if (number >= 0 && number < count) return;
  throw InputError(
      fmt::format("--shard {}: {} has shards 0 to {}", number, node.label(), count - 1));
}

std::string too_many_failed(const Plan& plan, const Node& node, const h5::File& file) {
  const auto num_failed = file.attribute<Index>("num_failed");
  const Index n = num_rows(plan, node);
  const double limit = plan.study.limits.max_failed_fraction;
  if (static_cast<double>(num_failed) <= limit * static_cast<double>(n)) return "";
  const SourceTraits& source = plan.study.source();
  return fmt::format(
      "{}: {} of {} rows failed ({}), limits.max_failed_fraction = {} allows {}; {}, or raise the "
      "limit",
      node.path.string(), num_failed, n, failures(file), limit,
      static_cast<Index>(limit * static_cast<double>(n)), source.advice);
}

h5::File open_simulation(const Plan& plan, const Node& node) {
  h5::File file = open_artefact(node, kSimulationSchema);
  const std::string failure = too_many_failed(plan, node, file);
  if (!failure.empty()) throw FailedRolloutsError(failure);
  return file;
}

}  // namespace npdr::pipeline
