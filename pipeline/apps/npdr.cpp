// The front door: `npdr <command>`.
#include <CLI/CLI.hpp>

#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"

int main(int argc, char** argv) {
  using namespace npdr::pipeline;
  CLI::App app(
      "npdr finds which physics parameters explain recorded motion, as a Bayesian posterior.",
      "npdr");
  app.require_subcommand(1);
  app.fallthrough(false);
  int result = 0;
  add_run_command(app, result);
  add_status_command(app, result);
  add_explain_command(app, result);
  add_validate_command(app, result);
  add_new_command(app, result);
  add_list_command(app, result);
  add_import_command(app, result);
  add_inspect_command(app, result);
  add_verify_command(app, result);
  add_sample_command(app, result);
  add_log_prob_command(app, result);
  int status = 0;
  if (!parse_command_line(app, argc, argv, status)) return status;
  return result;
}
