#include "pipeline/run/artefact_status.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <tuple>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"
#include "core/text.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/run/run_progress.h"
#include "pipeline/store/hostile_json.h"
#include "pipeline/store/seal.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::uintmax_t size_of_tree(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    const auto size = fs::file_size(path, error);
    return error ? 0 : size;
  }
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    const auto size = entry.file_size(error);
    if (!error) bytes += size;
  }
  return bytes;
}

// Of the report, which has no link, itself.
fs::path readable_link(const Plan& plan, const Node& node) {
  return node.stage == Stage::report ? node.path : link_of(plan, node, node.uses.front());
}

// What the readable link leads to where that is there, and another artefact than the plan's.
std::optional<fs::path> earlier_artefact(const Plan& plan, const Node& node) {
  std::error_code error;
  const fs::path found = fs::canonical(readable_link(plan, node), error);
  if (error || found.stem() == node.key) return std::nullopt;
  return found;
}

// What the readable link led to, where somebody has removed that.
std::optional<fs::path> removed_artefact(const Plan& plan, const Node& node) {
  const fs::path link = readable_link(plan, node);
  std::error_code error;
  if (!fs::is_symlink(link, error) || fs::exists(link, error)) return std::nullopt;
  return (link.parent_path() / fs::read_symlink(link, error)).lexically_normal();
}

// The schema of a checkpoint, and how it says how far the work has come: unit and attribute.
std::tuple<Schema, const char*, const char*> checkpoint_kind(const Plan& plan, const Node& node) {
  if (node.stage == Stage::policy) return {kPolicyCheckpointSchema, "iteration", "iteration"};
  if (node.stage == Stage::diagnose) return {kDiagnosisCheckpointSchema, "simulation", "num_done"};
  if (is_refinement(plan, node)) return {kRefinementCheckpointSchema, "simulation", "num_draws"};
  return {kCheckpointSchema, "epoch", "epochs"};
}

// Nothing: no part of it is there.
std::optional<std::string> partial_detail(const Plan& plan, const Node& node) {
  if (node.stage == Stage::simulate) {
    const Index total = num_shards(plan, node);
    const Index missing = std::ssize(missing_shards(plan, node));
    if (missing == total) return std::nullopt;
    return fmt::format("{} of {} shards", total - missing, total);
  }
  const auto [schema, unit, attribute] = checkpoint_kind(plan, node);
  const auto file = open_artefact_if_there(
      {plan.work.checkpoint(name_of(node.stage), node.key), node.key}, schema);
  if (!file) return std::nullopt;
  return fmt::format("checkpoint at {} {}", unit, file->attribute<Index>(attribute));
}

Json document_of(const fs::path& artefact) {
  if (artefact.extension() == ".json") {
    std::ifstream file(artefact);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    const Json json = json_in(text).value_or(Json());
    return json.is_object() ? json.value("key_document", Json::object()) : Json::object();
  }
  return read_artefact_info(artefact).identity.key_document;
}

// `text` without the beginning that a long one shares with `other`, but for some characters.
std::string shortened_from_difference(const std::string& text, const std::string& other) {
  constexpr std::ptrdiff_t kept = 20;
  constexpr std::size_t short_enough = 60;
  if (std::max(text.size(), other.size()) <= short_enough) return text;
  const auto differs = std::ranges::mismatch(text, other).in1;
  auto first = text.begin() + std::max<std::ptrdiff_t>(0, differs - text.begin() - kept);
  const auto is_within = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
  while (first != text.begin() && is_within(*first)) --first;
  return (first == text.begin() ? "" : "...") + shortened({first, text.end()});
}

// "training.learning_rate: 0.0003, was 0.001" for every leaf that differs.
void compare(const std::string& path, const Json& now, const Json& before,
             std::vector<std::string>& lines) {
  if (now == before) return;
  if (now.is_object() && before.is_object()) {
    const auto below = [&](const std::string& key) {
      return path.empty() ? key : path + "." + key;
    };
    for (const auto& [key, value] : now.items()) {
      if (before.contains(key)) {
        compare(below(key), value, before[key], lines);
      } else {
        lines.push_back(fmt::format("{}: {}, was not there", below(key), shortened(value.dump())));
      }
    }
    for (const auto& [key, value] : before.items()) {
      if (!now.contains(key)) {
        lines.push_back(fmt::format("{}: gone, was {}", below(key), shortened(value.dump())));
      }
    }
    return;
  }
  if (now.is_array() && before.is_array() && now.size() == before.size()) {
    for (std::size_t i = 0; i < now.size(); ++i) {
      compare(fmt::format("{}[{}]", path, i), now[i], before[i], lines);
    }
    return;
  }
  if (path.starts_with("inputs.")) {
    lines.push_back(fmt::format("input '{}' is another one", path.substr(7)));
    return;
  }
  const std::string one = now.dump(), other = before.dump();
  lines.push_back(fmt::format("{}: {}, was {}", path, shortened_from_difference(one, other),
                              shortened_from_difference(other, one)));
}

// Reads a shard that is there to the end; shards have checksums of their own.
void check_shard(const fs::path& shard) {
  if (!fs::exists(shard)) return;
  try {
    read_artefact_info(shard);
  } catch (const DamagedFile& error) {
    throw DamagedFile(std::string(error.what()) + "; remove this shard, too");
  }
}

// Throws InputError for an artefact that is damaged or lacks a part.
void check_artefact(const Plan& plan, const Node& node, Scrutiny scrutiny, ArtefactStatus& status) {
  std::vector<fs::path> shards;
  if (node.stage == Stage::simulate) {
    const h5::File file = open_artefact(node, kSimulationSchema);
    status.cost = provenance_of(file).cost;
    status.detail = too_many_failed(plan, node, file);
    if (!status.detail.empty()) status.state = ArtefactState::failed;
    shards = simulated_values(file).part_files();
  } else {
    const ArtefactInfo info = read_artefact_info(node.path);
    if (info.key != node.key) {
      throw InputError(fmt::format("{}: is another artefact, key {} of stage '{}', must be {}",
                                   node.path.string(), info.key, info.schema.stage, node.key));
    }
    status.cost = info.provenance.cost;
  }
  if (scrutiny == Scrutiny::quick) return;
  for (const fs::path& shard : shards) check_shard(shard);
  content_digest(node.path);
}

void read_status(const Plan& plan, const Node& node, Scrutiny scrutiny, ArtefactStatus& status) {
  if (is_complete(plan, node)) {
    status.state = ArtefactState::up_to_date;
    if (node.stage != Stage::report) check_artefact(plan, node, scrutiny, status);
    status.is_made = true;
    return;
  }
  if (scrutiny == Scrutiny::thorough && node.stage == Stage::simulate) {
    for (const Shard& shard : shards(plan, node)) check_shard(shard.path);
  }
  const std::optional<std::string> part = partial_detail(plan, node);
  status.detail = part.value_or("");
  status.earlier = earlier_artefact(plan, node);
  if (part) {
    status.state = ArtefactState::partial;
  } else if (status.earlier) {
    status.state = ArtefactState::stale;
  }
  const fs::path log = log_of(plan, node);  // of its jobs, those of earlier versions included
  std::error_code error;
  const auto size = fs::file_size(log, error);
  if (error || size == 0) return;
  if (part) status.detail += "; ";
  if (const auto failure = failure_in(log, node.key)) {
    status.state = ArtefactState::failed;
    status.detail += fmt::format("{}; log: {}", *failure, log.string());
  } else {
    status.detail += "what its jobs have said: " + log.string();
  }
}

}  // namespace

ArtefactStatus status_of(const Plan& plan, const Node& node, Scrutiny scrutiny) {
  ArtefactStatus status;
  status.bytes = size_of_tree(node.path);
  if (node.stage == Stage::simulate) {
    status.bytes += size_of_tree(fs::path(node.path).replace_extension());
  }
  const auto reject = [&status](const std::string& why) {  // must not hide how the others stand
    status.state = ArtefactState::stale;
    status.is_sound = false;
    status.detail = why;
  };
  try {
    read_status(plan, node, scrutiny, status);
  } catch (const DamagedFile& error) {
    reject(std::string("damaged, remove it: ") + error.what());
  } catch (const Error& error) {
    reject(std::string("can't be used: ") + error.what());
  } catch (const fs::filesystem_error& error) {
    reject(file_error_text(error.path1(), "be looked at", error.code().value()));
  }
  return status;
}

std::vector<int> processes_at_work(const Plan& plan) {
  std::map<fs::path, std::map<std::string, int>> folders;  // each is read once
  const auto in_the_making = [&](const fs::path& folder) -> const auto& {
    const auto [found, is_new] = folders.try_emplace(folder);
    if (is_new) found->second = files_in_the_making(folder);
    return found->second;
  };
  const auto process_of = [&](const Node& node) {
    if (is_complete(plan, node)) return 0;
    const auto& files = in_the_making(node.path.parent_path());
    const auto own = files.find(node.path.filename().string());
    if (own != files.end()) return own->second;
    if (node.stage != Stage::simulate) return 0;
    const auto& of_shards = in_the_making(plan.work.shard(node.key, {}).parent_path());
    return of_shards.empty() ? 0 : of_shards.begin()->second;
  };
  std::vector<int> processes;
  for (const Node& node : plan.nodes) {
    processes.push_back(0);
    try {
      processes.back() = process_of(node);
    } catch (const std::exception&) {
      // The artefact's own status says so.
    }
  }
  return processes;
}

std::vector<std::string> reasons(const Plan& plan, const Node& node) {
  if (is_complete(plan, node)) {
    const ArtefactStatus status = status_of(plan, node);
    return {status.state == ArtefactState::up_to_date ? "it is up to date" : status.detail};
  }
  if (const auto removed = removed_artefact(plan, node)) {
    const bool is_its = removed->stem() == node.key;
    return {fmt::format("{} was removed: {}", is_its ? "its file" : "an earlier version's file",
                        removed->string())};
  }
  const ArtefactStatus status = status_of(plan, node);
  if (status.state == ArtefactState::partial && !status.earlier) {
    return {"it isn't finished: " + status.detail};
  }
  if (status.state == ArtefactState::failed) return {"its last run failed: " + status.detail};
  std::vector<std::string> lines;
  if (const auto earlier = earlier_artefact(plan, node)) {
    compare("", node.identity.key_document, document_of(*earlier), lines);
    if (lines.empty()) lines.emplace_back("its files are gone");
  } else if (status.is_sound) {
    lines.emplace_back("it was never made");
  }
  if (!status.detail.empty()) lines.push_back(status.detail);
  return lines;
}

}  // namespace npdr::pipeline
