#include "pipeline/apps/help_format.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/process/fitted_text.h"

namespace npdr::pipeline {
namespace {

constexpr int kColumns = 80;
constexpr int kNameColumns = 34;
constexpr int kWordColumns = kColumns - kNameColumns;
constexpr std::size_t kMostChoices = 4;  // that stand beside an option's name

bool has_many_choices(const CLI::Option& option) {
  return choices_of(option).size() > kMostChoices;
}

// CLI11 lists all words that it has no place for, and says that a command is missing where one is
// unknown.
std::string cause_of(const CLI::App& command, const CLI::Error& error) {
  std::vector<std::string> commands, options;
  for (const CLI::App* below : command.get_subcommands({})) commands.push_back(below->get_name());
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  }
  for (const std::string& word : command.remaining()) {
    const std::string name = word.substr(0, word.find('='));
    if (name.starts_with("--")) return unknown_name("option", name, options);
    if (!commands.empty()) return unknown_name("command", word, commands);
  }
  return error.what();
}

}  // namespace

HelpFormatter::HelpFormatter() { column_width(kNameColumns); }

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (!has_many_choices(*option)) return CLI::Formatter::make_option_opts(option);
  return option->get_positional() ? "" : " NAME";
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  std::string words = option->get_description();
  if (has_many_choices(*option)) {
    words += (words.empty() ? "" : ": ") + join(choices_of(*option));
  }
  return wrapped(words, kWordColumns);
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  std::stringstream out;
  CLI::detail::format_help(out, command->get_name(),
                           wrapped(command->get_description(), kWordColumns), get_column_width());
  return out.str();
}

std::string words_of_failure(const CLI::App* app, const CLI::Error& error) {
  const auto called = app->get_subcommands();
  const bool is_front_door = !app->get_subcommands({}).empty();
  if (is_front_door && called.empty()) {
    return fmt::format(
        "{}: {}; 'npdr new NAME' begins a study, 'npdr run STUDY' brings one up to date, 'npdr "
        "help' lists all commands\n",
        app->get_name(), app->remaining().empty() ? "no command" : cause_of(*app, error));
  }
  const CLI::App& command = called.empty() ? *app : *called.front();
  return fmt::format(
      "{}: {}; options and examples: {}\n",
      called.empty() ? app->get_name() : "npdr " + command.get_name(), cause_of(command, error),
      called.empty() ? app->get_name() + " --help" : "npdr help " + command.get_name());
}

}  // namespace npdr::pipeline
