/// Simulation artefacts: shards, and the file that joins them. A shard holds a range of rows. The
/// joined file holds the trajectories as a virtual dataset over the shards, and copies of the rest.
#pragma once

#include <vector>

#include "core/target.h"
#include "pipeline/artefacts/work_folder.h"
#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// The dataset of a simulation that holds what was simulated: trajectories, or x. Throws
/// InputError.
h5::Dataset simulated_values(const h5::File& file);

/// Makes the empty datasets of `num_rows` rows. Throws Error.
void create_simulation_datasets(h5::File& file, const Study& study, const Target& target,
                                Index num_rows);

std::vector<std::uint8_t> as_bytes(const std::vector<sim::RolloutStatus>& status);

/// The identity of the shard of these rows.
Identity shard_identity(const Identity& simulation, RowRange rows);

/// A shard's rows and its file.
struct Shard {
  RowRange rows;
  std::filesystem::path path;
};

/// Joins the shards of a simulation, all of which are there, with their warnings and the one that
/// all rows give together ("": none). Throws InputError for a damaged one, Error when writing
/// fails.
void join_shards(const ArtefactFile& simulation, const Identity& identity, const Study& study,
                 const Target& target, const std::vector<Shard>& shards,
                 const std::string& warning);

/// Says of a shard or a simulation what is probably wrong with its rows (first_rows.h). No warnings
/// leave it as it is.
void write_warnings(h5::File& file, const std::vector<std::string>& warnings);
/// Empty: none. Throws InputError.
std::vector<std::string> warnings_of(const h5::File& file);

/// "3 crashed, 1 timed_out": how the rows of an open simulation failed. Throws InputError.
std::string failures(const h5::File& simulation);

}  // namespace npdr::pipeline
