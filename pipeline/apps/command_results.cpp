// Commands that say where a study's results are, and hand them to other programs.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/error.h"
#include "core/printable.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/verdict_lines.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/report/inference_data.h"

namespace npdr::pipeline {
namespace {

void print_place(const std::string& what, const std::filesystem::path& path, bool is_there) {
  fmt::print("{:<12} {}{}\n", what, printable_line(path.string()),
             is_there ? "" : "  (isn't there yet, or is of other settings: npdr run)");
}

ExitStatus open_study(const StudyArguments& arguments, bool in_browser) {
  const Plan plan = arguments.plan_here("npdr open");
  const bool is_there = is_complete(plan, plan.nodes.back());
  const std::filesystem::path folder = plan.work.study(plan.study.name);
  if (in_browser && is_there) {
    execlp("xdg-open", "xdg-open", report_path(plan).c_str(), nullptr);
    throw Error("xdg-open can't be started; open " + report_path(plan).string() + " yourself");
  }
  print_place("report", report_path(plan), is_there);
  print_place("tables", folder / "tables", is_there);
  print_place("figures", folder / "figures", is_there);
  for (const auto& [node, use] : last_nodes(plan, Stage::infer)) {
    print_place("posterior", link_of(plan, *node, use), is_complete(plan, *node));
  }
  return ExitStatus::done;
}

struct ExportArguments {
  StudyArguments study;
  std::string output;
  bool force = false;
  Index num_predictions = 100;
};

void export_study(const ExportArguments& arguments) {
  const Plan plan = arguments.study.plan_here("npdr export");
  const std::string method = last_nodes_of_method(plan, Stage::evaluate).front().use.method;
  if (arguments.output.ends_with(".csv")) {
    throw InputError(arguments.output + ": would hold NetCDF; call it .nc");
  }
  require_new_file(arguments.output, arguments.force);
  write_inference_data(plan, arguments.output, arguments.num_predictions);
  print_line("wrote {}", arguments.output);
  warn_of_failed_checks(plan, method);
}

}  // namespace

Action open_command(CLI::App& command) {
  auto arguments = std::make_shared<StudyArguments>();
  auto in_browser = std::make_shared<bool>(false);
  arguments->add_to(command);
  command.add_flag("--browser", *in_browser, "open the report with xdg-open instead");
  command.footer("Example:\n  npdr open study.toml --browser");
  return [arguments, in_browser] { return open_study(*arguments, *in_browser); };
}

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
  return done_after([arguments] { export_study(*arguments); });
}

}  // namespace npdr::pipeline
