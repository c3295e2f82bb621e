/// Rows of a refinement that several processes simulate: its own, and helpers beside it. Private to
/// pipeline/stages.
///
/// The file tree is the only state: there are no claims, locks, clocks or messages. The refinement
/// writes which rows it wants next (asked_rows_file.h), and everybody makes the shards of them
/// whose likelihoods aren't there: first a segment of its own, then all others. Whoever comes by a
/// missing shard makes it; one may be made several times, with the same bits. When the refinement
/// has come by all of them, all are there. So a helper that dies costs nothing, and a refinement
/// that goes on from its checkpoint finds the likelihoods that were made for it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/artefacts/asked_rows_file.h"
#include "pipeline/stages/simulated_likelihood.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {

/// The order in which a helper, or the refinement, comes by shards: those of its own segment
/// forwards, then the others in an order of its own, so that two that have nothing left don't
/// follow each other.
std::vector<std::size_t> walking_order(std::size_t num_shards, const Helper& walker);

class RefinedRows {
 public:
  using OnRows = std::function<void(Index)>;

  /// Keeps a reference to the likelihood, whose simulations begin where rows are asked to.
  RefinedRows(const Plan& plan, const Node& node, SimulatedLikelihood& likelihood,
              const Helper& walker);

  /// Whether helpers were there: they make the folder in which rows are asked for.
  bool has_helpers() const { return std::filesystem::is_directory(folder_); }

  /// The refinement's part. What is asked for, simulated together with the helpers, all rows in
  /// one; calls `on_rows` with how many of them are there. None: a stop was requested; what is made
  /// of them stays. Throws InputError for damaged files, Error when writing fails, and as the
  /// likelihood.
  std::optional<SimulatedRows> ask(AskedRows asked, const OnRows& on_rows);
  /// Removes what is simulated of rows before number `end`, which a checkpoint holds.
  void forget(Index end);
  /// What this process has simulated, but not read: the refinement that goes on from here will take
  /// it for the work of others.
  double unread_core_seconds() const;
  /// What others did for the rows that were asked for.
  const Cost& cost_of_others() const { return cost_of_others_; }

  /// A helper's part: simulates shards of what is asked for now, and calls `on_rows` likewise.
  /// Returns how many rows it simulated; 0: none is missing, but those that all fail here. Throws
  /// as ask().
  Index help(const OnRows& on_rows);

 private:
  bool is_helper() const { return walker_.number > 0; }
  Index walk(const AskedRows& asked, const std::vector<AskedShard>& shards, bool must_be_asked,
             const OnRows& on_rows);
  Index make(const AskedRows& asked, const AskedShard& shard);
  std::optional<SimulatedRows> read(const AskedRows& asked, const std::vector<AskedShard>& shards);

  void while_it_lasts(const std::function<void()>& write) const;

  const Plan& plan_;
  const Node& node_;
  SimulatedLikelihood& likelihood_;
  Helper walker_;  // of the rows: the refinement, or a helper
  std::filesystem::path folder_;
  std::map<std::string, double> own_;  // core-seconds of what the refinement made and hasn't read
  std::set<std::string> failed_;       // those of which all rows failed here
  Cost cost_of_others_;
};

}  // namespace npdr::pipeline
