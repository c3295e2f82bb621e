#include "pipeline/apps/completion.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/config/study_reader.h"

namespace npdr::pipeline {
namespace {

// By shell.
const std::map<std::string, std::string> kScripts = {
    {"bash", R"sh(# Completion of npdr for bash: eval "$(npdr completion bash)"
_npdr() {
  local word words=("${COMP_WORDS[@]:1:COMP_CWORD}")
  COMPREPLY=()
  while IFS=$'\t' read -r word _; do
    COMPREPLY+=("$(printf %q "$word")")
  done < <("${COMP_WORDS[0]/#~\//$HOME/}" __complete "${words[@]//\\/}" 2> /dev/null)
}
complete -o default -F _npdr npdr
)sh"},
    {"fish",
     R"sh(# Completion of npdr for fish: npdr completion fish > ~/.config/fish/completions/npdr.fish
complete -c npdr -n __fish_use_subcommand -f
complete -c npdr -a '(npdr __complete (commandline -opc)[2..-1] (commandline -ct) 2> /dev/null)'
)sh"},
    {"zsh", R"sh(#compdef npdr
# Completion of npdr for zsh: npdr completion zsh > FOLDER/_npdr, in a folder of $fpath
_npdr() {
  local -a found
  local word
  for word in ${(f)"$(npdr __complete "${(@Q)words[2,CURRENT]}" 2> /dev/null)"}; do
    if [[ $word == *$'\t'* ]]; then found+=(${word/$'\t'/:}); else found+=(${word//:/\\:}); fi
  done
  if (($#found)); then _describe word found; else _files; fi
}
_npdr "$@"
)sh"}};

// A word, and what is said of it.
using Offers = std::vector<std::pair<std::string, std::string>>;

Offers offered_words(const std::vector<std::string>& words) {
  Offers offers;
  for (const std::string& word : words) offers.emplace_back(word, "");
  return offers;
}

Offers offered_commands(const CLI::App& app) {
  Offers offers;
  for (const CLI::App* command : app.get_subcommands({})) {
    offers.emplace_back(command->get_name(), command->get_description());
  }
  return offers;
}

Offers offered_options(const CLI::App& command) {
  Offers offers;
  for (const CLI::Option* option : command.get_options()) {
    const std::string doc = option->get_description();
    for (const std::string& name : option->get_lnames()) offers.emplace_back("--" + name, doc);
    for (const std::string& name : option->get_snames()) offers.emplace_back("-" + name, doc);
  }
  return offers;
}

// Of an option with methods: those of the study that the words name.
Offers offered_values(const CLI::Option& option, const std::vector<std::string>& words) {
  if (!option.check_name("--method")) return offered_words(choices_of(option));
  Offers offers;
  for (const std::string& word : words) {
    if (!word.ends_with(".toml")) continue;
    for (const MethodConfig& m : read_study(word, {}).methods) offers.emplace_back(m.name, "");
    break;
  }
  return offers;
}

Offers offered_choices(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const std::vector<std::string> choices = choices_of(*option);
    if (option->get_positional() && !choices.empty()) return offered_words(choices);
  }
  return {};
}

Offers all_offers(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.size() < 2) return offered_commands(app);
  const auto named = [&](const CLI::App* command) { return command->check_name(words.front()); };
  const auto commands = app.get_subcommands(named);
  if (commands.empty()) return {};
  const CLI::App& command = *commands.front();
  const std::string& before = words[words.size() - 2];
  const CLI::Option* option =
      before.starts_with('-') ? command.get_option_no_throw(before) : nullptr;
  if (option != nullptr && option->get_items_expected_max() > 0) {
    return offered_values(*option, words);
  }
  return words.back().starts_with('-') ? offered_options(command) : offered_choices(command);
}

}  // namespace

std::vector<std::string> completion_shells() { return {"bash", "zsh", "fish"}; }

std::string completion_script(const std::string& shell) {
  const auto script = kScripts.find(shell);
  if (script == kScripts.end()) {
    throw InputError(unknown_name("shell", shell, completion_shells()));
  }
  return script->second;
}

std::string completions(CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  std::string text;
  for (const auto& [word, all_doc] : all_offers(app, words)) {
    if (!word.starts_with(words.back())) continue;
    const std::string doc = all_doc.substr(0, all_doc.find('\n'));
    text += word + (doc.empty() ? "" : "\t" + doc) + "\n";
  }
  return text;
}

}  // namespace npdr::pipeline
