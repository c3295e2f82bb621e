#include <fmt/format.h>
#include <strings.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include "core/feature_names.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/import/csv_import.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {
namespace {

struct ImportArguments {
  std::vector<std::string> files;
  std::string theta, x;  // in their place: a dataset
  std::string output;
  std::string simulator;
  std::vector<std::string> states, actions;
  std::string delimiter = ",";
  bool decimal_comma = false;
  std::vector<std::string> scales;
  std::string window, length;  // empty: none
  CsvOptions options;          // those that are taken as they are
  bool force = false;

  bool has_recording_options() const {
    const CsvOptions& o = options;
    return !files.empty() || !simulator.empty() || !states.empty() || !actions.empty() || o.dt ||
           o.resample || !scales.empty() || !o.unwrap.empty() || !window.empty() ||
           !length.empty() || !o.check_rates || o.at_rest || !o.source.empty();
  }
};

// Where a link to a file leads, which is there or not: that is written, and the link stays one.
std::string past_links(const std::string& output) {
  namespace fs = std::filesystem;
  constexpr int most = 40;
  std::error_code error;
  if (fs::is_other(fs::status(output, error))) return output;
  fs::path path = output;
  for (int i = 0; i < most && fs::is_symlink(path, error); ++i) {
    path = path.parent_path() / fs::read_symlink(path, error);
  }
  return path.string();
}

// Nothing that was measured may get lost: `-o run_*.csv` names a CSV file first.
void check_output(const ImportArguments& arguments) {
  const std::filesystem::path output = arguments.output;
  if (::strcasecmp(output.extension().c_str(), ".csv") == 0) {
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
  require_new_file(output, arguments.force);
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

// A recording's channels are told apart by their labels, states and actions alike.
void require_distinct_labels(const Channels& channels) {
  std::set<std::string> labels;
  for (const auto* kind : {&channels.states, &channels.actions}) {
    for (const Channel& channel : *kind) {
      if (labels.insert(channel.label).second) continue;
      throw InputError("--states and --actions: '" + channel.label +
                       "' is named twice; name each column once");
    }
  }
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
  if (arguments.states.empty()) {
    throw InputError(
        "say which columns to take: --simulator NAME, or --states 'theta [rad],theta_dot [rad/s]' "
        "and --actions 'voltage [V]', if it has any");
  }
  Channels channels{parse_channels(arguments.states), parse_channels(arguments.actions)};
  require_distinct_labels(channels);
  return channels;
}

// "theta=0.0174533".
std::vector<ColumnScale> parse_scales(const std::vector<std::string>& texts) {
  std::vector<ColumnScale> scales;
  for (const std::string& text : texts) {
    const std::size_t sign = std::min(text.rfind('='), text.size());
    const char *const end = text.data() + text.size(), *const begin = text.data() + sign + 1;
    double factor = 0.0;
    const bool is_number = begin < end && std::from_chars(begin, end, factor).ptr == end;
    if (!is_number || !std::isfinite(factor) || factor == 0.0 || sign == 0) {
      throw InputError(
          "--scale " + text +
          ": must be COLUMN=FACTOR, such as theta=0.0174533, with a factor that isn't 0");
    }
    const std::string label = text.substr(0, sign);
    if (std::ranges::count(scales, label, &ColumnScale::label) > 0) {
      throw InputError("--scale: column '" + label + "' has two factors; give their product");
    }
    scales.push_back({label, factor});
  }
  return scales;
}

// 0: of the shortest rollout.
Index parse_length(const std::string& text) {
  if (text == "shortest") return 0;
  const std::optional<Index> length = parse_count(text);
  if (length && *length > 0) return *length;
  throw InputError("--length " + text + ": must be 'shortest' or a number of steps, 1 or more");
}

CsvOptions csv_options(const ImportArguments& arguments) {
  CsvOptions options = arguments.options;
  options.channels = channels_of_arguments(arguments);
  options.format = parse_csv_format(arguments.delimiter, arguments.decimal_comma);
  options.scales = parse_scales(arguments.scales);
  options.differentiate = parse_count(arguments.window);
  if (!options.differentiate && !arguments.window.empty()) {
    throw InputError("--differentiate=" + arguments.window +
                     ", must be an odd number of samples, 5 or more, such as --differentiate=11");
  }
  if (!arguments.length.empty()) options.length = parse_length(arguments.length);
  return options;
}

void import_simulations(const ImportArguments& arguments) {
  if (arguments.theta.empty() || arguments.x.empty()) {
    throw InputError("a dataset is made of two CSV files: --theta FILE and --x FILE");
  }
  if (arguments.has_recording_options()) {
    throw InputError(
        "--theta and --x make a dataset; leave out recordings and what belongs to them");
  }
  const DatasetCounts counts =
      import_dataset(arguments.theta, arguments.x, arguments.output,
                     parse_csv_format(arguments.delimiter, arguments.decimal_comma));
  for (const std::string& file : counts.unended) {
    print_line("{}", text_of(warning_of_end(file)));
  }
  print_line("wrote {}: {} rows; theta {}; x {}{}", arguments.output, counts.num_rows,
             join(feature_names(counts.parameters)), join(feature_names(counts.features)),
             counts.num_failed == 0 ? ""
                                    : fmt::format("; counted as failed, not being finite: {} of x",
                                                  counted(counts.num_failed, "row")));
  const std::string file = shell_word(arguments.output);
  print_line("next: npdr new NAME --dataset {}; npdr run STUDY.toml --set simulator.dataset={}",
             file, file);
}

void import_recording(const ImportArguments& arguments) {
  if (arguments.files.empty()) {
    throw InputError("name recordings, CSV files with a rollout each, or --theta and --x");
  }
  // A window behind a blank is read as a file: whether there is one is optional. So is a second
  // factor of --scale.
  for (const std::string& file : arguments.files) {
    if (std::filesystem::exists(file)) continue;
    if (!arguments.window.empty() && parse_count(file)) {
      throw InputError(file + ": isn't there; if it is a window, write --differentiate=" + file);
    }
    if (!arguments.scales.empty() && file.find('=') != std::string::npos) {
      throw InputError(file + ": isn't there; if it is a factor, write --scale " +
                       join(arguments.scales, ",") + "," + file);
    }
  }
  const auto [target, findings] =
      import_csv({arguments.files.begin(), arguments.files.end()}, csv_options(arguments));
  write_recording(target, arguments.output);
  for (const Finding& finding : findings) print_line("{}", text_of(finding));
  print_line("wrote {}: {} of {} steps of {} s; states {}; actions {}", arguments.output,
             counted(target.num_rollouts(), "rollout"), target.num_steps(), target.dt,
             to_string(target.state_channels), to_string(target.action_channels));
  print_line(
      "next: npdr run STUDY.toml --set target.recording={}; npdr new NAME writes a study to start "
      "from",
      shell_word(arguments.output));
}

void import(ImportArguments arguments) {
  arguments.output = past_links(arguments.output);
  check_output(arguments);
  const bool is_dataset = !arguments.theta.empty() || !arguments.x.empty();
  is_dataset ? import_simulations(arguments) : import_recording(arguments);
}

constexpr const char* kExample =
    "Example: encoders alone, of a lab with decimal commas, whose clock jitters:\n"
    "  npdr import run*.csv --simulator furuta --delimiter ';' --decimal-comma --resample 0.004 "
    "\\\n"
    "    --unwrap alpha --differentiate -o recording.h5\n"
    "What each option does to the numbers: docs/file-formats.md, 'Recordings as CSV'.\n";

// Adds the options for how a file's lines are read.
void add_format_options(CLI::App& command, ImportArguments& arguments) {
  command.add_option("--delimiter", arguments.delimiter, "between columns: ',', ';', '|' or tab")
      ->capture_default_str();
  command.add_flag("--decimal-comma", arguments.decimal_comma, "1,5 is one and a half");
  command.add_option("--dt", arguments.options.dt, "[s] where there is no column 't [s]'");
}

// Adds an option for columns, with commas between them or repeated.
void add_columns_option(CLI::App& command, const std::string& name,
                        std::vector<std::string>& columns, const std::string& doc) {
  command.add_option(name, columns, doc)->delimiter(',')->allow_extra_args(false);
}

// Adds the options for what is done to the numbers.
void add_correction_options(CLI::App& command, ImportArguments& arguments) {
  add_columns_option(command, "--scale", arguments.scales,
                     "COLUMN=FACTOR, such as theta=0.0174533; may be repeated");
  add_columns_option(command, "--unwrap", arguments.options.unwrap,
                     "state whose jumps of a whole turn are taken out; may be repeated");
  command.add_option("--resample", arguments.options.resample,
                     "[s] of an even grid, for clocks that jitter: interpolates states, holds "
                     "actions");
  command.add_flag(fmt::format("--differentiate{{{}}}", kRateWindow), arguments.window,
                   "compute states X_dot that the files lack of X; --differentiate=WINDOW: over so "
                   "many samples");
  command.add_flag("--at-rest", arguments.options.at_rest,
                   "the device stands still at the first states: computed rates are 0 there");
  command.add_option("--length", arguments.length,
                     "'shortest' or a number of steps to cut all rollouts into");
  command.add_flag_callback(
      "--no-rate-check", [&arguments] { arguments.options.check_rates = false; },
      "accept angles that wrap, and X_dot that isn't the slope of X");
}

}  // namespace

Action import_command(CLI::App& command) {
  auto arguments = std::make_shared<ImportArguments>();
  command.add_option("CSV", arguments->files, "one file per rollout, header 'label [unit],...'");
  command.add_option("--theta", arguments->theta,
                     "instead: parameters of finished simulations, a header with their names");
  command.add_option("--x", arguments->x, "with --theta: features, as many rows");
  command.add_option("-o,--output", arguments->output, "the HDF5 file to write")->required();
  command.add_option("--simulator", arguments->simulator, "take this simulator's channels");
  add_columns_option(command, "--states", arguments->states,
                     "columns, with commas between them, such as 'theta [rad],alpha [rad]'");
  add_columns_option(command, "--actions", arguments->actions, "columns, such as 'voltage [V]'");
  add_format_options(command, *arguments);
  add_correction_options(command, *arguments);
  command.add_flag("--force", arguments->force, "replace an HDF5 file that is there already");
  command.add_option("--source", arguments->options.source,
                     "where the recordings come from, for people");
  command.footer(kExample);
  return done_after([arguments] { import(*arguments); });
}

}  // namespace npdr::pipeline
