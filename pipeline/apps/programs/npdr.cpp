// The front door: `npdr <command>`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"

namespace {

// CLI11 only says that a command is missing.
bool is_unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return false;
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (std::ranges::find(known, argv[1]) != known.end()) return false;
  fmt::print(stderr, "npdr: {}\n", npdr::unknown_name("command", argv[1], known));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace npdr::pipeline;
  CLI::App app(
      "npdr finds which physics parameters explain recorded motion, as a Bayesian posterior.",
      "npdr");
  app.require_subcommand(1);
  app.fallthrough(false);
  int result = 0;
  add_run_command(app, result);
  add_submit_command(app, result);
  add_cancel_command(app, result);
  add_tasks_command(app, result);
  add_task_command(app, result);
  add_status_command(app, result);
  add_explain_command(app, result);
  add_validate_command(app, result);
  add_new_command(app, result);
  add_list_command(app, result);
  add_open_command(app, result);
  add_import_command(app, result);
  add_inspect_command(app, result);
  add_verify_command(app, result);
  add_sample_command(app, result);
  add_log_prob_command(app, result);
  add_compare_command(app, result);
  add_evidence_command(app, result);
  add_export_command(app, result);
  add_help_commands(app, result);
  app.footer("Examples:\n  npdr new study\n  npdr run study.toml\n  npdr help run");
  if (is_unknown_command(app, argc, argv)) return static_cast<int>(npdr::ExitStatus::invalid_input);
  int status = 0;
  if (!parse_command_line(app, argc, argv, status)) return status;
  return result;
}
