/// Rows of theta that a refinement wants to be simulated next, and their simulations, which helpers
/// share, in one folder (WorkFolder::asked_rows):
///
///   asked-<first>-<end>-<digits>.h5  the rows, while the refinement waits for them
///   rows-<begin>-<end>-<digits>.h5   likelihoods of some of them
///
/// Rows are counted over the whole refinement. Digits are of what is asked for, and of a key that
/// holds theta and the instruction set: what isn't of just these rows is never taken for them.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/work_folder.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

struct AskedRows {
  Index first = 0;              ///< number of the first row
  Index shard_size = 1;         ///< rows that are simulated together
  bool rollouts = false;        ///< wanted as well
  RowMatrix theta;              ///< (n, D)
  RowMatrix first_errors = {};  ///< (S, C) as SimulatedLikelihood::first_errors()

  Index end() const { return first + theta.rows(); }
  std::string file_name() const;
};
void describe(Layout f, AskedRows& asked);

/// The asked-for rows among the names of a folder, those that begin first come first.
std::vector<std::string> names_of_asked_rows(const std::set<std::string>& names);

/// Rows that have been simulated.
struct SimulatedRows {
  Vector log_likelihood;            ///< (m) [nats]; -infinity or NaN where it is 0
  Index num_failed = 0;             ///< of these rows
  sim::Trajectories rollouts = {};  ///< empty unless they were asked for
  Cost cost = {};                   ///< of whoever simulated them
};
void describe(Layout f, SimulatedRows& rows);

/// A shard of rows that are asked for, and the file of what becomes of it.
struct AskedShard {
  RowRange rows;  ///< counted from the first row that is asked for
  std::string key;
  std::string file_name;
};

/// The shards of rows that the refinement with the key `posterior` asks for, in their order.
std::vector<AskedShard> shards_of(const AskedRows& asked, const std::string& posterior);
/// What that is made from.
Identity identity_of(const AskedRows& asked, const AskedShard& shard, const Identity& posterior);

/// None: it isn't there any more. Throws InputError for a damaged file, or one of another shard.
std::optional<SimulatedRows> read_simulated_rows(const std::filesystem::path& folder,
                                                 const AskedShard& shard);

/// The end of the simulated rows whose file has this name; none: it is another file's.
std::optional<Index> end_of_rows(const std::string& file_name);

}  // namespace npdr::pipeline
