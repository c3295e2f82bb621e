/// Recordings: the HDF5 files that hold a target domain's rollouts; and target artefacts, which
/// hold the same or, where the simulator gives features, x_o.
///
///   states   (H, T+1, C) floats: the state before each action, and after the last
///   actions  (H, T, A) floats: what was applied during the step
///            both with attributes `labels` and `units`, one text per channel
///   rollout  (H) texts: the name of each recording; may be missing; texts have <= 255 bytes
///   file attributes: dt [s], a number; source, a text that may be missing
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/store/h5.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

struct ArtefactFile;

/// States and actions, in the order of their columns.
struct Channels {
  std::vector<Channel> states;
  std::vector<Channel> actions;
};

Channels channels_of(const sim::SimulatorInfo& info);

/// Throws InputError, which begins with `where`, unless `found` are the `expected` channels in
/// order.
void check_channels(const std::string& where, const std::vector<Channel>& found,
                    const std::vector<Channel>& expected);

/// "theta [rad], theta_dot [rad/s]".
std::string to_string(const std::vector<Channel>& channels);

/// Rollouts, and all channels that their file has.
struct Recording : Target {
  Channels recorded;
};

/// The `expected` channels are picked by label and unit, in their order, others left out. Rollouts
/// without names are called "0", "1", ... Throws InputError that names the file and what is wrong
/// with it: shapes, types, channels, dt, NaN (with rollout, channel and step), a truncated file. A
/// child process reads it first (outside_file.h), so no other thread may be using HDF5.
Recording read_recording(const std::filesystem::path& path,
                         const std::optional<Channels>& expected = std::nullopt);

/// Of an open file that is known to be intact, such as an artefact of ours.
Recording read_rollouts(const h5::File& file, const std::optional<Channels>& expected = {});

/// As a whole or not at all. Throws InputError when the target can't be valid, Error when writing
/// fails.
void write_recording(const Target& target, const std::filesystem::path& path);

/// Datasets and attributes of a recording. Throws Error.
void write_target(h5::File& file, const Target& target);

/// 32 hexadecimal digits that depend on all values, channels and dt; not on names and the source.
std::string content_hash(const Target& target);

/// Writes rollouts with their numbers. Throws Error.
void write_rollouts(h5::File& file, const Target& target);

/// Writes x_o: the state after the only step of the only rollout. Throws Error.
void write_observation(h5::File& file, const Target& target);

/// The target, whichever of both it is. Throws InputError.
Target read_target_artefact(const ArtefactFile& target);

}  // namespace npdr::pipeline
