// The command verify: recomputes some rows of an artefact, or all of it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/error.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/remake.h"
#include "pipeline/apps/verify.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kProgram = "npdr verify";
constexpr Index kMostRows = 100'000'000;

struct VerifyArguments {
  std::string path;
  bool all = false;
  VerifyOptions rows;
  StudyArguments remake;  ///< no file: rows are looked at
};

ExitStatus verify_rows(const std::string& path, const VerifyOptions& options) {
  const Verification found = verify(path, options);
  print_line("{}: {} of {} rows recomputed, {} differ", path, found.num_checked, found.num_rows,
             found.different.size());
  if (found.num_checked < found.num_rows) {
    const double share =
        static_cast<double>(found.num_checked) / static_cast<double>(found.num_rows);
    print_line("    a single bad row is found so with a probability of {:.3g} %; --all finds any",
               100.0 * share);
  }
  for (const Index row : found.different) fmt::print("    row {}\n", row);
  return found.different.empty() ? ExitStatus::done : ExitStatus::failed;
}

ExitStatus verify_by_remake(const std::string& path, const StudyArguments& study) {
  Remake remake(path, study.plan());
  report_error(kProgram, "makes again " + remake.title());
  const std::string difference = remake.difference_of_builds();
  if (!difference.empty()) {
    report_warning(kProgram, difference + "; bits may differ for that reason alone");
  }
  const bool is_same = remake.gives_same_bits();
  print_line("{}: made again, with {} bits", path, is_same ? "the same" : "OTHER");
  return is_same ? ExitStatus::done : ExitStatus::failed;
}

}  // namespace

Action verify_command(CLI::App& command) {
  auto arguments = std::make_shared<VerifyArguments>();
  command.add_option("FILE", arguments->path, "artefact, such as simulate.h5")->required();
  auto* rows = command.add_option("--rows", arguments->rows.count, "how many")
                   ->capture_default_str()
                   ->check(CLI::Range(Index{1}, kMostRows));
  auto* all = command.add_flag("--all", arguments->all, "all rows");
  add_seed_option(command, "--pick", arguments->rows.pick, "picks the rows");
  command.add_flag("--run-command", arguments->rows.runs_command,
                   "run the program or library that the file names, which can do all that you can");
  auto* remake =
      command
          .add_option("--remake", arguments->remake.file,
                      "the study that FILE was made from: make all of it again, such as by "
                      "training, from the inputs in the folder of --work; FILE stays as it is")
          ->type_name("STUDY")
          ->excludes(rows)
          ->excludes(all);
  arguments->remake.add_settings_to(command);
  for (const char* setting : {"--set", "--work"}) command.get_option(setting)->needs(remake);
  command.footer(
      "Examples:\n"
      "  npdr verify runs/study/npe/seed-1/round-1/simulate.h5\n"
      "  npdr verify runs/study/npe/seed-1/round-1/infer.h5 --remake study.toml");
  return [arguments] {
    if (!arguments->remake.file.empty()) {
      return verify_by_remake(arguments->path, arguments->remake);
    }
    if (arguments->all) arguments->rows.count = kMostRows;
    return verify_rows(arguments->path, arguments->rows);
  };
}

}  // namespace npdr::pipeline
