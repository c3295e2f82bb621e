// The command that hands a study's results to other programs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/printable.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/report/inference_data.h"

namespace npdr::pipeline {
namespace {

struct ExportArguments {
  StudyArguments study;
  std::string output;
  Index num_predictions = 100;
};

}  // namespace

void add_export_command(CLI::App& app, int& result) {
  auto* command = app.add_subcommand(
      "export", "a method's posteriors as InferenceData (NetCDF), for ArviZ and xarray");
  auto arguments = std::make_shared<ExportArguments>();
  arguments->study.add_to(*command);
  command->add_option("-o,--output", arguments->output, "file to write, such as out.nc")
      ->required();
  command
      ->add_option("--predictions", arguments->num_predictions,
                   "draws of each seed whose rollouts are simulated; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(Index{0}, Index{1'000'000}));
  command->footer(
      "Example: npdr export study.toml --only NPE -o out.nc; in Python: "
      "arviz.from_netcdf(\"out.nc\")\n"
      "Seeds are chains. What stands in the file: docs/python.md.");
  command->callback([&result, arguments] {
    result = guarded_main("npdr export", [&] {
      write_inference_data(arguments->study.plan(), arguments->output, arguments->num_predictions);
      fmt::print("wrote {}\n", printable_line(arguments->output));
      return ExitStatus::done;
    });
  });
}

}  // namespace npdr::pipeline
