// The command that hands a study's results to other programs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/error.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/verdict_lines.h"
#include "pipeline/report/inference_data.h"

namespace npdr::pipeline {
namespace {

struct ExportArguments {
  StudyArguments study;
  std::string output;
  bool force = false;
  Index num_predictions = 100;
};

void export_study(const ExportArguments& arguments) {
  const Plan plan = arguments.study.plan_here("npdr export");
  if (arguments.output.ends_with(".csv")) {
    throw InputError(arguments.output + ": would hold NetCDF; call it .nc");
  }
  require_new_file(arguments.output, arguments.force);
  const std::string method =
      write_inference_data(plan, arguments.output, arguments.num_predictions);
  print_line("wrote {}", arguments.output);
  warn_of_failed_checks(plan, method);
}

}  // namespace

Action export_command(CLI::App& command) {
  auto arguments = std::make_shared<ExportArguments>();
  arguments->study.add_to(command);
  command.add_option("-o,--output", arguments->output, "file to write, such as out.nc")->required();
  command.add_flag("--force", arguments->force, "replace an HDF5 file that is there already");
  command
      .add_option("--predictions", arguments->num_predictions,
                  "draws of each seed whose rollouts are simulated; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(Index{0}, Index{1'000'000}));
  command.footer(
      "Example:\n"
      "  npdr export study.toml --only NPE -o out.nc   arviz.from_netcdf(\"out.nc\")\n"
      "Seeds are chains. What stands in the file: docs/python.md.");
  return [arguments] {
    export_study(*arguments);
    return ExitStatus::done;
  };
}

}  // namespace npdr::pipeline
