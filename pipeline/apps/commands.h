/// The commands of `npdr`. Each function adds its options and examples to a command, and returns
/// what the command does once they are read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/apps/command_line.h"

namespace npdr::pipeline {

OptionAdder run_command, submit_command, cancel_command, tasks_command, task_command,
    status_command, explain_command, validate_command, new_command, list_command, open_command,
    import_command, inspect_command, verify_command, sample_command, log_prob_command,
    compare_command, evidence_command, export_command, help_command, man_command,
    completion_command;

/// In the order of the help.
constexpr Command kCommands[] = {
    {"run", "bring a study up to date; skip what is", &run_command},
    {"submit", "bring a study up to date by jobs of Slurm", &submit_command},
    {"cancel", "end a study's jobs that wait or run", &cancel_command},
    {"tasks", "a command a line for all that can be made now, for batch systems of every kind",
     &tasks_command},
    {"task", "run a program as the task of a batch job: log, signals, queueing again",
     &task_command},
    {"status", "one row per artefact: where it stands; what the checks say", &status_command},
    {"explain", "why artefacts aren't up to date", &explain_command},
    {"validate", "check a study; print the work it implies", &validate_command},
    {"new", "start a study: from a commented template, or for a simulator or recording of yours",
     &new_command},
    {"list", "what a study can choose from", &list_command},
    {"open", "where a study's report, tables and posteriors are", &open_command},
    {"import", "CSV recordings to a recording file, or simulations to a dataset (HDF5)",
     &import_command},
    {"inspect", "what a file of ours holds, who made it, and from what", &inspect_command},
    {"verify",
     "recompute random rows of a simulation or proposal, or all of any artefact, and compare bit "
     "for bit",
     &verify_command},
    {"sample", "samples of a trained posterior, as CSV", &sample_command},
    {"log-prob", "posterior densities of the parameters in a file", &log_prob_command},
    {"compare", "how far apart two sets of samples are: C2ST, MMD, moments", &compare_command},
    {"evidence", "which physics, prior and noise explains a recording best: log Z, Bayes factors",
     &evidence_command},
    {"export", "a method's posteriors for ArviZ and xarray", &export_command},
    {"help", "what a command does, its options and examples", &help_command},
    {"man", "the page for 'man', of all commands", &man_command},
    {"completion", "lines for a shell, which completes words of npdr with them",
     &completion_command}};

/// Rows of an artefact that were made again.
struct Verification {
  Index num_rows = 0;
  Index num_checked = 0;
  std::vector<Index> different;  ///< rows whose bits differ
};

struct VerifyOptions {
  Index count = 10;           ///< rows
  std::uint64_t pick = 0;     ///< picks them
  bool runs_command = false;  ///< that the file names, whoever made it
};

/// Recomputes random rows of a simulation (or one of its shards), with their status, and compares
/// their theta with the proposal's; or rows of a first round's proposal. The target that a
/// simulation was replayed against is found in the cache beside it, as the proposal is. Throws
/// InputError for another kind of file, one whose key isn't that of its key document, and one whose
/// rows come from a program or library that it names itself, unless that may be run.
Verification verify(const std::filesystem::path& given, const VerifyOptions& options);

/// The hidden command that the shells' lines call: `npdr __complete WORDS...`.
constexpr const char* kCompleteCommand = "__complete";

/// Words that the last of `words`, those of a command line behind "npdr", may become, a line each,
/// with a tabulator and a description where there is one: commands of `app`, options of the
/// command, values that are one of a few (set_choices()), methods of the study that is named. None:
/// names of files, which shells complete.
std::string completions(CLI::App& app, const std::vector<std::string>& words);

}  // namespace npdr::pipeline
