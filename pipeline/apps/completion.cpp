#include "pipeline/apps/completion.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/apps/command_line.h"

namespace npdr::pipeline {
namespace {

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

bool is_positional(const CLI::Option& option) { return option.get_positional(); }

// "--jobs", "-j".
std::vector<std::string> words_of(const CLI::Option& option) {
  std::vector<std::string> words;
  for (const std::string& name : option.get_lnames()) words.push_back("--" + name);
  for (const std::string& name : option.get_snames()) words.push_back("-" + name);
  return words;
}

// Between single quotes of any of the shells, on one line.
std::string quoted_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else {
      result += c == '\n' ? ' ' : c;
    }
  }
  return "'" + result + "'";
}

std::string bash_of(CLI::App& app) {
  std::vector<std::string> commands;
  std::string words, values;
  for (const CLI::App* command : app.get_subcommands({})) {
    commands.push_back(command->get_name());
    std::vector<std::string> options, choices;
    for (const CLI::Option* option : command->get_options()) {
      const auto names = words_of(*option);
      options.insert(options.end(), names.begin(), names.end());
      const auto values_of_option = choices_of(*option);
      if (is_positional(*option)) {
        choices = values_of_option.empty() ? choices : values_of_option;
      } else if (!values_of_option.empty()) {
        for (const std::string& name : names) {
          values += fmt::format("    '{} {}') words='{}' ;;\n", command->get_name(), name,
                                join(values_of_option, " "));
        }
      } else if (takes_value(*option)) {
        for (const std::string& name : names) {
          values += fmt::format("    '{} {}') return ;;\n", command->get_name(), name);
        }
      }
    }
    words += fmt::format("    {}) words='{}'; [[ $word == -* ]] || words='{}' ;;\n",
                         command->get_name(), join(options, " "), join(choices, " "));
  }
  return fmt::format(R"sh(# Completion of npdr for bash: eval "$(npdr completion bash)"
_npdr() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} words=''
  COMPREPLY=()
  case ${{COMP_WORDS[1]}} in
{}    *) words='{}' ;;
  esac
  ((COMP_CWORD == 1)) && words='{}'
  case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD - 1]}}" in
{}  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}
complete -o default -F _npdr npdr
)sh",
                     words, join(commands, " "), join(commands, " "), values);
}

// One option of zsh's _arguments: '--until[doc]:value:(a b)'.
std::string zsh_option(const CLI::Option& option, const std::string& name) {
  std::string doc = option.get_description();
  std::erase_if(doc, [](char c) { return c == '[' || c == ']' || c == ':'; });
  std::string text = name + "[" + doc + "]";
  const auto choices = choices_of(option);
  if (!choices.empty()) {
    text += ":value:(" + join(choices, " ") + ")";
  } else if (takes_value(option)) {
    text += ":value:_files";
  }
  return quoted_text(text);
}

std::string zsh_of(CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : app.get_subcommands({})) {
    commands += "    " + quoted_text(command->get_name() + ":" + command->get_description()) + "\n";
    std::string options, rest = " '*:file:_files'";
    for (const CLI::Option* option : command->get_options()) {
      const auto choices = choices_of(*option);
      if (is_positional(*option) && !choices.empty())
        rest = " '*:word:(" + join(choices, " ") + ")'";
      for (const std::string& name : words_of(*option)) options += " " + zsh_option(*option, name);
    }
    cases += fmt::format("    {}) _arguments{}{} ;;\n", command->get_name(), options, rest);
  }
  return fmt::format(R"sh(#compdef npdr
# Completion of npdr for zsh: npdr completion zsh > FOLDER/_npdr, in a folder of $fpath
_npdr() {{
  local -a commands=(
{}  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{}  esac
}}
_npdr "$@"
)sh",
                     commands, cases);
}

std::string fish_of(CLI::App& app) {
  std::string text =
      "# Completion of npdr for fish: npdr completion fish > "
      "~/.config/fish/completions/npdr.fish\n";
  for (const CLI::App* command : app.get_subcommands({})) {
    text += fmt::format("complete -c npdr -n __fish_use_subcommand -f -a {} -d {}\n",
                        command->get_name(), quoted_text(command->get_description()));
    const std::string begin =
        fmt::format("complete -c npdr -n '__fish_seen_subcommand_from {}'", command->get_name());
    for (const CLI::Option* option : command->get_options()) {
      const auto choices = choices_of(*option);
      std::string line;
      for (const std::string& name : option->get_lnames()) line += " -l " + name;
      for (const std::string& name : option->get_snames()) line += " -s " + name;
      if (!choices.empty()) {
        line +=
            std::string(line.empty() ? " -f" : " -x") + " -a " + quoted_text(join(choices, " "));
      } else if (takes_value(*option)) {
        line += line.empty() ? "" : " -r";
      }
      if (!line.empty())
        text += begin + line + " -d " + quoted_text(option->get_description()) + "\n";
    }
  }
  return text;
}

}  // namespace

std::vector<std::string> completion_shells() { return {"bash", "zsh", "fish"}; }

std::string completion_of(CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_of(app);
  if (shell == "zsh") return zsh_of(app);
  if (shell == "fish") return fish_of(app);
  throw InputError(unknown_name("shell", shell, completion_shells()));
}

}  // namespace npdr::pipeline
