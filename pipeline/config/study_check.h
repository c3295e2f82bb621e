/// Rules between a study and its data, once these have been read, and warnings of a valid study.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "pipeline/config/reading.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Sizes of the rollouts that are known before any is simulated.
struct RolloutShape {
  Index num_rollouts = 0, num_steps = 0;
  std::vector<Channel> state_channels;
};

/// Adds what doesn't fit to `reading`; a field that already has a problem isn't checked.
void check_rollouts(const Study& study, const RolloutShape& shape, Reading& reading);

/// The same for the recording of a study that has been read: throws InputError with a line per
/// problem, at the place where the key stands, and for a dt that isn't that of the study's
/// [policy].
void check_recording(const Study& study, const Target& recording);

/// Says which channel of the rollouts is 0 throughout one of them, but perhaps for its first or
/// last state: no error can be given in units of its maximum. "": none.
std::string motion_problem(const Study& study, const Target& rollouts);
/// Throws InputError with that.
void require_motion(const Study& study, const Target& rollouts);

/// Throws InputError where a method wants more rows than the dataset has, or these can't be
/// counted.
void check_dataset_rows(const Study& study, Index num_rows);

/// Gives the parameters of the prior the units that a dataset has for them, in the prior's order;
/// describes them where the study doesn't. Throws InputError where it says another unit, or the
/// dataset one that a study can't have.
void take_units(Study& study, const std::vector<Channel>& parameters);

/// Why a command for a shell can't be run in `folder`, without running it: the program that it
/// begins with has a path and isn't there or may not be executed, or is an interpreter whose script
/// isn't there. Empty where nothing of that kind is certain: words with quotes, variables or
/// options are left to the shell.
std::string program_fault(const std::string& command, const std::filesystem::path& folder);
/// The program that a command begins with where it is a mere name and no shell of this machine
/// finds it; else empty. Another machine may.
std::string unknown_program(const std::string& command);

/// What in a valid study is probably not what was meant. `info`: of its simulator.
Findings warnings_of(const Study& study, const sim::SimulatorInfo& info);

}  // namespace npdr::pipeline
