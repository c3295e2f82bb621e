/// Proposal artefacts: theta of a round's simulations. Simulation artefacts: shards, and the file
/// that joins them. A shard holds a range of rows. The joined file holds the trajectories as a
/// virtual dataset over the shards, and copies of the rest.
#pragma once

#include <vector>

#include "core/target.h"
#include "inference/prior.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/work_folder.h"
#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

struct Proposal {
  RowMatrix theta;                              ///< (N, D)
  std::vector<inference::Marginal> parameters;  ///< of theta's columns; not read
};
void describe(Layout f, Proposal& proposal);

/// The dataset theta (N, D), in the order of the prior. Throws InputError.
h5::Dataset open_proposal(const ArtefactFile& proposal);

/// Rows [begin, end) of it. Throws InputError for one that isn't finite.
RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows);

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

/// Joins the shards of a simulation, with `warnings`, which all rows give together, and their own.
/// Throws InputError for a damaged one, Error when writing fails.
void join_shards(const ArtefactFile& simulation, const Identity& identity, const Study& study,
                 const Target& target, const std::vector<Shard>& shards,
                 std::vector<std::string> warnings);

/// Warnings of a shard's or a simulation's rows (first_rows.h). None leave the file as it is.
void write_warnings(h5::File& file, const std::vector<std::string>& warnings);
/// Empty: none. Throws InputError.
std::vector<std::string> warnings_of(const h5::File& file);

/// "2 %: 3 crashed, 1 timed_out": how the rows of an open simulation failed. Throws InputError.
std::string failures(const h5::File& simulation);

}  // namespace npdr::pipeline
