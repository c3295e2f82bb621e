// Commands that tell of all commands, by the descriptions that the command line is parsed by.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/apps/completion.h"
#include "pipeline/apps/man_page.h"

namespace npdr::pipeline {
namespace {

std::vector<std::string> names_of_commands(CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string help_of(CLI::App& app, const std::string& name) {
  // app.help() would be that of the command that was called.
  if (name.empty()) {
    return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
  }
  const auto commands =
      app.get_subcommands([&](const CLI::App* c) { return c->get_name() == name; });
  if (commands.empty()) throw InputError(unknown_name("command", name, names_of_commands(app)));
  return commands.front()->help(app.get_name());
}

// Adds a command of one word, whose text is printed. Returns the word's option.
CLI::Option* add_text_command(CLI::App& app, CLI::App* command, const std::string& word,
                              int& result,
                              std::string (*text_of)(CLI::App& app, const std::string& word)) {
  auto given = std::make_shared<std::string>();
  CLI::Option* option = word.empty() ? nullptr : command->add_option(word, *given);
  command->callback([&app, &result, given, text_of, name = command->get_name()] {
    result = guarded_main("npdr " + name, [&] {
      fmt::print("{}", text_of(app, *given));
      return ExitStatus::done;
    });
  });
  return option;
}

}  // namespace

void add_help_commands(CLI::App& app, int& result) {
  auto* help = app.add_subcommand("help", "what a command does, its options and examples");
  auto* man = app.add_subcommand("man", "the page for 'man', of all commands");
  auto* completion = app.add_subcommand(
      "completion", "lines for a shell, which completes words of npdr with them");
  set_choices(*add_text_command(app, help, "COMMAND", result, &help_of), names_of_commands(app));
  add_text_command(app, man, "", result,
                   [](CLI::App& all, const std::string&) { return man_page(all); });
  CLI::Option* shell = add_text_command(app, completion, "SHELL", result, &completion_of);
  set_choices(*shell->required(), completion_shells());
  help->footer("Example:\n  npdr help run");
  man->footer("Example:\n  npdr man > npdr.1 && man ./npdr.1");
  completion->footer(
      "Examples:\n  eval \"$(npdr completion bash)\"\n"
      "  npdr completion fish > ~/.config/fish/completions/npdr.fish");
}

}  // namespace npdr::pipeline
