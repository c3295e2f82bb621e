#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "core/feature_names.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/csv_import.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/artefacts/recording.h"

namespace npdr::pipeline {
namespace {

struct ImportArguments {
  std::vector<std::string> files;
  std::string theta, x;  // in their place: a dataset
  std::string output;
  std::string simulator;
  std::vector<std::string> states, actions;
  std::optional<double> dt;
  std::string source;
  bool force = false;
};

// Nothing that was measured may get lost: `-o run_*.csv` names a CSV file first.
void check_output(const ImportArguments& arguments) {
  const std::filesystem::path output = arguments.output;
  if (output.extension() == ".csv") {
    throw InputError(output.string() + ": is to hold HDF5, must not end in .csv");
  }
  std::error_code error;
  std::vector<std::string> inputs = arguments.files;
  inputs.insert(inputs.end(), {arguments.theta, arguments.x});
  for (const std::string& input : inputs) {
    if (std::filesystem::equivalent(input, output, error)) {
      throw InputError(output.string() + ": is one of the inputs, must be another file");
    }
  }
  if (std::filesystem::exists(output, error) && !arguments.force) {
    throw InputError(output.string() + ": is there already; choose another name or add --force");
  }
}

std::vector<Channel> parse_channels(const std::vector<std::string>& texts) {
  std::vector<Channel> channels;
  for (const std::string& text : texts) {
    const std::size_t open = text.find('[');
    if (open != std::string::npos && text.find(']', open) == std::string::npos) {
      throw InputError("'" + text + "': the unit's ']' is missing");
    }
    channels.push_back(parse_channel(text));
  }
  return channels;
}

Channels channels_of_arguments(const ImportArguments& arguments) {
  if (!arguments.simulator.empty()) {
    if (!arguments.states.empty() || !arguments.actions.empty()) {
      throw InputError("--simulator " + arguments.simulator +
                       " says which columns to take; leave out --states and --actions, or it");
    }
    sim::SimulatorConfig config;
    config.name = arguments.simulator;
    return channels_of(sim::make_simulator(config)->info());
  }
  if (arguments.states.empty() || arguments.actions.empty()) {
    throw InputError("say which columns to take: --simulator NAME, or --states and --actions");
  }
  return {parse_channels(arguments.states), parse_channels(arguments.actions)};
}

// Finished simulations have no channels, times or rollouts.
void check_dataset_arguments(const ImportArguments& arguments) {
  if (arguments.theta.empty() || arguments.x.empty()) {
    throw InputError("a dataset is made of two CSV files: --theta FILE and --x FILE");
  }
  const bool has_others = !arguments.files.empty() || !arguments.simulator.empty() ||
                          !arguments.states.empty() || !arguments.actions.empty() || arguments.dt ||
                          !arguments.source.empty();
  if (!has_others) return;
  throw InputError("--theta and --x make a dataset; leave out recordings and what belongs to them");
}

void import_simulations(const ImportArguments& arguments) {
  check_dataset_arguments(arguments);
  const DatasetCounts counts = import_dataset(arguments.theta, arguments.x, arguments.output);
  fmt::print(
      "wrote {}: {} rows; theta {}; x {}{}\n", arguments.output, counts.num_rows,
      fmt::join(feature_names(counts.parameters), ", "),
      fmt::join(feature_names(counts.features), ", "),
      counts.num_failed == 0
          ? ""
          : fmt::format("; {} rows of x aren't finite and count as failed", counts.num_failed));
}

void import(const ImportArguments& arguments) {
  check_output(arguments);
  if (!arguments.theta.empty() || !arguments.x.empty()) return import_simulations(arguments);
  if (arguments.files.empty()) {
    throw InputError("name recordings, CSV files with a rollout each, or --theta and --x");
  }
  CsvOptions options;
  options.channels = channels_of_arguments(arguments);
  options.dt = arguments.dt;
  options.source = arguments.source;
  const Target target = import_csv({arguments.files.begin(), arguments.files.end()}, options);
  write_recording(target, arguments.output);
  fmt::print("wrote {}: {} rollouts of {} steps of {} s; states {}; actions {}\n", arguments.output,
             target.num_rollouts(), target.num_steps(), target.dt, to_string(target.state_channels),
             to_string(target.action_channels));
}

}  // namespace

void add_import_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand(
      "import", "CSV recordings to a recording file, or simulations to a dataset (HDF5)");
  auto arguments = std::make_shared<ImportArguments>();
  command->add_option("CSV", arguments->files, "one file per rollout, header 'label [unit],...'");
  command->add_option("--theta", arguments->theta,
                      "instead: parameters of finished simulations, a header with their names");
  command->add_option("--x", arguments->x, "with --theta: features, as many rows");
  command->add_option("-o,--output", arguments->output, "the HDF5 file to write")->required();
  command->add_option("--simulator", arguments->simulator, "take this simulator's channels");
  command->add_option("--states", arguments->states, "columns, such as 'theta [rad],alpha [rad]'")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--actions", arguments->actions, "columns, such as 'voltage [V]'")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--dt", arguments->dt, "[s] where there is no column 't [s]'");
  command->add_flag("--force", arguments->force, "replace an output file that is there already");
  command->add_option("--source", arguments->source, "where the recordings come from, for people");
  command->callback([&result, arguments] {
    result = guarded_main("npdr import", [&] {
      import(*arguments);
      return ExitStatus::done;
    });
  });
}

}  // namespace npdr::pipeline
