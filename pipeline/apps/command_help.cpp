// Commands that tell of all commands, by the descriptions that the command line is parsed by.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/completion.h"
#include "pipeline/process/build_info.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kExitStatus = R"(.SH EXIT STATUS
0 done; 1 failed; 2 invalid input; 3 too many failed rollouts; 4 a check failed (npdr run \-\-strict);
75 stopped with everything saved, run it again.
.SH ENVIRONMENT
.TP
.B OMP_NUM_THREADS
threads of a stage's executable that is called alone
.TP
.B NPDR_SITE
file with a table [cluster], for npdr submit
)";

std::vector<std::string> names_of_commands() {
  std::vector<std::string> names;
  for (const Command& command : kCommands) names.emplace_back(command.name);
  return names;
}

std::string help_of(const CLI::App& app, const std::string& name) {
  // app.help() would be that of the command that was called.
  if (name.empty()) {
    return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
  }
  const auto commands = app.get_subcommands([&](const auto* c) { return c->check_name(name); });
  if (commands.empty()) throw InputError(unknown_name("command", name, names_of_commands()));
  return commands.front()->help(app.get_name());
}

// Help of all commands as it is, in the language of man(7).
std::string man_page(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH NPDR 1 \"\" \"npdr {}\"\n.SH NAME\nnpdr \\- physics parameters of recorded motion, as a "
      "Bayesian posterior\n.SH COMMANDS\n",
      creator_version());
  for (const std::string& name : names_of_commands()) {
    // Each line begins with something that is no request of man's, whatever comes then.
    std::string help = "\\&" + replaced_all(help_of(app, name), "\\", "\\e");
    help = replaced_all(replaced_all(help, "-", "\\-"), "\n", "\n\\&");
    text += fmt::format(".SS npdr {}\n.nf\n{}\n.fi\n", replaced_all(name, "-", "\\-"), help);
  }
  return text + kExitStatus;
}

}  // namespace

Action help_command(CLI::App& command) {
  auto name = std::make_shared<std::string>();
  set_choices(*command.add_option("COMMAND", *name), names_of_commands());
  command.footer("Example:\n  npdr help run");
  return done_after([app = command.get_parent(), name] { fmt::print("{}", help_of(*app, *name)); });
}

Action man_command(CLI::App& command) {
  command.footer("Example:\n  npdr man > npdr.1 && man ./npdr.1");
  return done_after([app = command.get_parent()] { fmt::print("{}", man_page(*app)); });
}

Action completion_command(CLI::App& command) {
  auto shell = std::make_shared<std::string>();
  set_choices(*command.add_option("SHELL", *shell)->required(), completion_shells());
  command.footer(
      "Examples:\n  eval \"$(npdr completion bash)\"\n"
      "  npdr completion fish > ~/.config/fish/completions/npdr.fish");
  return done_after([shell] { fmt::print("{}", completion_script(*shell)); });
}

}  // namespace npdr::pipeline
