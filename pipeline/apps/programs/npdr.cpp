// The front door: `npdr <command>`. Called by the name of a stage's executable, such as
// `npdr-simulate`, which is a link to this program, it is that stage.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/completion.h"
#include "pipeline/apps/stage_main.h"

namespace npdr::pipeline {
namespace {

// CLI11 only says that a command is missing.
bool is_unknown_command(const std::string& word) {
  if (word.starts_with('-')) return false;
  std::vector<std::string> known;
  for (const Command& command : kCommands) known.emplace_back(command.name);
  if (std::ranges::find(known, word) != known.end()) return false;
  fmt::print(stderr, "npdr: {}\n", unknown_name("command", word, known));
  return true;
}

int npdr_main(int argc, char** argv) {
  CLI::App app(
      "npdr finds which physics parameters explain recorded motion, as a Bayesian posterior.",
      "npdr");
  app.require_subcommand(1);
  app.fallthrough(false);
  int result = 0;
  for (const Command& command : kCommands) add_command(app, command, result);
  app.footer("Examples:\n  npdr new study\n  npdr run study.toml\n  npdr help run");
  if (argc > 1 && argv[1] == std::string_view(kCompleteCommand)) {
    return guarded_main("npdr", [&] {
      fmt::print("{}", completions(app, {argv + 2, argv + argc}));
      return ExitStatus::done;
    });
  }
  if (argc > 1 && is_unknown_command(argv[1])) return static_cast<int>(ExitStatus::invalid_input);
  int status = 0;
  return parse_command_line(app, argc, argv, status) ? result : status;
}

}  // namespace
}  // namespace npdr::pipeline

int main(int argc, char** argv) {
  const std::string name = std::filesystem::path(argc > 0 ? argv[0] : "").filename();
  if (npdr::pipeline::is_stage_program(name)) return npdr::pipeline::stage_main(name, argc, argv);
  return npdr::pipeline::npdr_main(argc, argv);
}
