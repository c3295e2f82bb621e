/// Rows of theta that a refinement wants to be simulated next, and their likelihoods, by which it
/// shares its simulations with helpers. All of them lie in one folder (WorkFolder::asked_rows):
///
///   asked-<first>-<end>.h5                the rows, while the refinement waits for them
///   rows-<begin>-<end>-<digits>.h5        likelihoods of some of them; the digits are of their
///   key,
///                                         which holds theta: those of other rows are never taken
/// Rows are counted over the whole refinement.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/artefacts/work_folder.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

struct AskedRows {
  Index first = 0;       ///< number of the first row
  Index shard_size = 1;  ///< rows that are simulated together
  RowMatrix theta;       ///< (n, D)

  Index end() const { return first + theta.rows(); }
  std::string file_name() const;
};

/// Writes what the refinement `posterior` asks for. Throws Error.
void write_asked_rows(const std::filesystem::path& folder, const Identity& posterior,
                      AskedRows asked);
/// None: it isn't there any more. Throws InputError for a damaged file, or one of another
/// refinement.
std::optional<AskedRows> read_asked_rows(const ArtefactFile& artefact);

/// The asked-for rows among the names of a folder, those that begin first come first.
std::vector<std::string> names_of_asked_rows(const std::set<std::string>& names);

/// Likelihoods of a shard of rows.
struct RowLikelihoods {
  Vector log_likelihood;  ///< (m) [nats]; -infinity or NaN where it is 0
  Index num_failed = 0;   ///< of these rows
  Cost cost;              ///< of whoever simulated them; set by reading
};

/// A shard of rows that are asked for, and the file of its likelihoods.
struct AskedShard {
  RowRange rows;  ///< counted from the first row that is asked for
  std::string key;
  std::string file_name;
};

/// The shards of rows that the refinement with the key `posterior` asks for, in their order.
std::vector<AskedShard> shards_of(const AskedRows& asked, const std::string& posterior);
/// What the likelihoods of a shard are made from.
Identity identity_of(const AskedRows& asked, const AskedShard& shard, const Identity& posterior);

/// Fills a file whose identity is that of the shard. Throws Error.
void write_row_likelihoods(h5::File& file, RowLikelihoods likelihoods);
/// None: it isn't there any more. Throws InputError for a damaged file, or one of another shard.
std::optional<RowLikelihoods> read_row_likelihoods(const std::filesystem::path& folder,
                                                   const AskedShard& shard);

/// The end of the rows whose likelihoods have this name; none: it is another file's.
std::optional<Index> end_of_rows(const std::string& file_name);

}  // namespace npdr::pipeline
