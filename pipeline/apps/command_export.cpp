// The command that hands a study's results to other programs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/error.h"
#include "core/printable.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/verdict_lines.h"
#include "pipeline/report/chain_files.h"
#include "pipeline/report/inference_chains.h"
#include "pipeline/report/inference_data.h"

namespace npdr::pipeline {
namespace {

struct ExportArguments {
  StudyArguments study;
  std::string output;
  bool force = false;
  Index num_predictions = 100;
  std::string format = name_of(ExportFormat::netcdf);
};

std::vector<std::string> write_files(const Plan& plan, const ExportArguments& arguments,
                                     bool has_predictions) {
  const auto format = parse_enum<ExportFormat>("format", arguments.format);
  if (format == ExportFormat::netcdf && arguments.output.ends_with(".csv")) {
    throw InputError(arguments.output +
                     ": would hold NetCDF; call it .nc, or add --format cmdstan for CSV files");
  }
  if (format != ExportFormat::netcdf) {
    if (!has_predictions) return write_chain_files(plan, arguments.output, format);
    throw InputError("--predictions: only the format netcdf holds rollouts; leave it out");
  }
  require_new_file(arguments.output, arguments.force);
  write_inference_data(plan, arguments.output, arguments.num_predictions);
  return {arguments.output};
}

void export_study(const ExportArguments& arguments, bool has_predictions) {
  const Plan plan = arguments.study.plan_here("npdr export");
  const std::string method = find_chains(plan).method;
  print_line("wrote {}", join(write_files(plan, arguments, has_predictions)));
  warn_of_failed_checks(plan, method);
}

}  // namespace

Action export_command(CLI::App& command) {
  auto arguments = std::make_shared<ExportArguments>();
  arguments->study.add_to(command);
  command
      .add_option("-o,--output", arguments->output,
                  "file to write, such as out.nc; of getdist and cmdstan, its beginning")
      ->required();
  command.add_flag("--force", arguments->force, "replace an HDF5 file that is there already");
  set_choices(
      *command
           .add_option("--format", arguments->format,
                       "NetCDF (InferenceData of ArviZ), chains of GetDist, CSV as of CmdStan")
           ->capture_default_str(),
      names_of<ExportFormat>());
  CLI::Option* predictions =
      command
          .add_option("--predictions", arguments->num_predictions,
                      "draws of each seed whose rollouts are simulated; 0: none")
          ->capture_default_str()
          ->check(CLI::Range(Index{0}, Index{1'000'000}));
  command.footer(
      "Examples:\n"
      "  npdr export study.toml --only NPE -o out.nc   arviz.from_netcdf(\"out.nc\")\n"
      "  npdr export study.toml --only NPE --format getdist -o chains/npe\n"
      "Seeds are chains. What stands in the file: docs/python.md.");
  return [arguments, predictions] {
    export_study(*arguments, predictions->count() > 0);
    return ExitStatus::done;
  };
}

}  // namespace npdr::pipeline
