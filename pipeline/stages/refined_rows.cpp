#include "pipeline/stages/refined_rows.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"
#include "core/stop_request.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/stage_parts.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr useconds_t kPause = 100'000;  // [us]
constexpr Index kMostPauses = 600;      // without any row, until names that can't be read are told

// Asks the server of a network file system, where looking for one name may tell what was there a
// while ago. None where the folder isn't there.
std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code gone;
  fs::directory_iterator entry(folder, gone);
  for (; !gone && entry != fs::directory_iterator(); entry.increment(gone)) {
    names.insert(entry->path().filename());
  }
  if (gone && gone != std::errc::no_such_file_or_directory) throw_read_error(folder, gone.value());
  return names;
}

void append(SimulatedRows& all, const SimulatedRows& rows) {
  const Index num_before = all.log_likelihood.size();
  all.log_likelihood.conservativeResize(num_before + rows.log_likelihood.size());
  all.log_likelihood.tail(rows.log_likelihood.size()) = rows.log_likelihood;
  all.num_failed += rows.num_failed;
  all.rollouts.append(rows.rollouts);
}

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

std::vector<std::size_t> walking_order(std::size_t num_shards, const Helper& walker) {
  const auto number = static_cast<std::size_t>(walker.number),
             count = static_cast<std::size_t>(walker.count) + 1;
  const std::size_t begin = num_shards * number / count, end = num_shards * (number + 1) / count;
  std::vector<std::size_t> order, others;
  for (std::size_t i = 0; i < num_shards; ++i) {
    (begin <= i && i < end ? order : others).push_back(i);
  }
  const std::uint64_t seed = static_cast<std::uint64_t>(walker.number);
  Stream stream({seed, "refine_shards", 0, 0, 0});
  for (const std::uint32_t i : stream.permutation(static_cast<std::uint32_t>(others.size()))) {
    order.push_back(others[i]);
  }
  return order;
}

RefinedRows::RefinedRows(const Plan& plan, const Node& node, SimulatedLikelihood& likelihood,
                         const Helper& walker)
    : plan_(plan),
      node_(node),
      likelihood_(likelihood),
      walker_(walker),
      folder_(plan.work.asked_rows(node.key)) {}

std::optional<SimulatedRows> RefinedRows::ask(AskedRows asked, const OnRows& on_rows) {
  const Index each = (asked.theta.rows() + walker_.count) / (walker_.count + 1);
  asked.shard_size = std::clamp<Index>(each, 1, plan_.study.simulate.shard_size);
  asked.first_errors = likelihood_.first_errors();
  const std::vector<AskedShard> shards = shards_of(asked, node_.key);
  const std::string asked_name = asked.file_name();
  std::error_code ignored;
  for (const std::string& name : names_of_asked_rows(names_in(folder_))) {
    // A process that was killed waits for them no more.
    if (name != asked_name) fs::remove(folder_ / name, ignored);
  }
  while_it_lasts([&] { kAskedRowsSchema.write(folder_ / asked_name, node_.identity, asked); });
  std::optional<SimulatedRows> result;
  for (Index num_pauses = 0; !result; ++num_pauses) {
    make_folder(folder_);  // another run of this refinement may have ended, and removed it
    if (walk(asked, shards, false, on_rows) > 0) num_pauses = 0;
    if (stop_requested()) return std::nullopt;
    result = read(asked, shards);
    if (result) break;
    // Another run of this refinement has removed some, or a network shows them late.
    if (num_pauses == kMostPauses) {
      throw Error(folder_.string() +
                  ": names of simulated rows are in it whose files aren't there; remove this "
                  "folder and run again");
    }
    usleep(kPause);
  }
  // Before any of the rows: helpers take those that aren't asked for as done.
  fs::remove(folder_ / asked_name, ignored);
  return result;
}

double RefinedRows::unread_core_seconds() const {
  double sum = 0.0;
  for (const auto& [name, core_seconds] : own_) sum += core_seconds;
  return sum;
}

void RefinedRows::forget(Index end) {
  std::error_code ignored;
  for (const std::string& name : names_in(folder_)) {
    const std::optional<Index> its_end = end_of_rows(name);
    if (!its_end || *its_end > end) continue;
    fs::remove(folder_ / name, ignored);
  }
}

Index RefinedRows::help(const OnRows& on_rows) {
  Index num_made = 0;
  const std::vector<std::string> names = names_of_asked_rows(names_in(folder_));
  if (names.empty()) failed_.clear();
  for (const std::string& name : names) {
    const std::optional<AskedRows> asked =
        kAskedRowsSchema.read_if_there({folder_ / name, node_.key});
    if (!asked) continue;
    const RowMatrix own = likelihood_.first_errors();
    const Index dimension = std::ssize(plan_.study.prior);
    if (asked->theta.cols() != dimension || asked->file_name() != name ||
        asked->first_errors.rows() != own.rows() || asked->first_errors.cols() != own.cols()) {
      throw InputError(fmt::format(
          "{}: asks for {} of {} parameters, must be for those of its name, of {}; remove this "
          "file",
          (folder_ / name).string(), asked->file_name(), asked->theta.cols(), dimension));
    }
    likelihood_.begin_without(asked->first_errors);
    num_made += walk(*asked, shards_of(*asked, node_.key), true, on_rows);
    if (num_made > 0) break;  // rows that come first may be asked for by now
  }
  return num_made;
}

// Makes the shards that are missing; `must_be_asked`: as long as they are asked for. Returns the
// number of rows that were simulated.
Index RefinedRows::walk(const AskedRows& asked, const std::vector<AskedShard>& shards,
                        bool must_be_asked, const OnRows& on_rows) {
  Index num_made = 0;
  const std::string asked_name = asked.file_name();
  std::set<std::string> there = names_in(folder_);
  for (const std::size_t i : walking_order(shards.size(), walker_)) {
    if (there.contains(shards[i].file_name) || failed_.contains(shards[i].file_name)) continue;
    there = names_in(folder_);  // others may have made it meanwhile
    Index num_there = 0;
    for (const AskedShard& shard : shards) {
      if (there.contains(shard.file_name)) num_there += shard.rows.size();
    }
    on_rows(num_there);
    if (there.contains(shards[i].file_name)) continue;
    if (stop_requested() || (must_be_asked && !there.contains(asked_name))) break;
    num_made += make(asked, shards[i]);
  }
  return num_made;
}

// Gives up when somebody else is first, or a stop is requested. Returns the number of rows that
// were simulated.
Index RefinedRows::make(const AskedRows& asked, const AskedShard& shard) {
  const Index count = shard.rows.size();
  const fs::path path = folder_ / shard.file_name;
  const auto start = Clock::now();
  Index at = 0;
  while_it_lasts([&] {
    SimulatedRows made;
    for (Index rows = 0; at < count; at += rows) {
      if (stop_requested() || fs::exists(path)) return;
      rows = std::min(likelihood_.block_size(count), count - at);
      const Index begin = shard.rows.begin + at;
      SimulatedRows block;
      block.rollouts =
          likelihood_.simulate(asked.theta.middleRows(begin, rows), asked.first + begin);
      block.log_likelihood = likelihood_.of(block.rollouts, block.num_failed);
      if (!asked.rollouts) block.rollouts = {};
      append(made, block);
    }
    if (is_helper() && made.num_failed == count) {
      failed_.insert(shard.file_name);  // perhaps this node's fault: the refinement makes it itself
      return;
    }
    if (fs::exists(path)) return;  // which the refinement may be reading
    const Cost cost = made.cost = cost_of_seconds(seconds_since(start));
    kSimulatedRowsSchema.write(path, identity_of(asked, shard, node_.identity), std::move(made));
    if (!is_helper()) own_[shard.file_name] = cost.core_seconds;
  });
  return at;
}

// Writes into the folder. What fails because it has gone can be made again, and is of no use to a
// helper whose refinement is complete by now.
void RefinedRows::while_it_lasts(const std::function<void()>& write) const {
  try {
    write();
  } catch (const Error&) {
    if (fs::is_directory(folder_) && !(is_helper() && is_complete(plan_, node_))) throw;
  }
}

// None: some aren't there.
std::optional<SimulatedRows> RefinedRows::read(const AskedRows& asked,
                                               const std::vector<AskedShard>& shards) {
  SimulatedRows all;
  Cost cost_of_others;
  for (const AskedShard& shard : shards) {
    const std::optional<SimulatedRows> part = read_simulated_rows(folder_, shard);
    if (!part) return std::nullopt;
    const Index rows = part->rollouts.num_rows, wanted = likelihood_.num_values();
    const Index num_values = part->rollouts.row_size();
    if (asked.rollouts && (rows != shard.rows.size() || num_values != wanted)) {
      throw InputError(fmt::format(
          "{}: {} rollouts of {} numbers, must be {} of {}; remove this file",
          (folder_ / shard.file_name).string(), rows, num_values, shard.rows.size(), wanted));
    }
    append(all, *part);
    // This process has worked or waited meanwhile.
    if (!own_.contains(shard.file_name)) cost_of_others.core_seconds += part->cost.core_seconds;
  }
  cost_of_others_ += cost_of_others;
  for (const AskedShard& shard : shards) own_.erase(shard.file_name);
  return all;
}

Index help_refinement(const Plan& plan, const Node& node, const Helper& helper, double patience) {
  wait_for_inputs(plan, node, patience);
  // Beside that of the refinement: programs of both write at the same time.
  const fs::path log =
      fs::path(node.path).replace_extension(fmt::format("helper-{}.log", helper.number));
  SimulatedLikelihood likelihood(plan, node, log);
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
