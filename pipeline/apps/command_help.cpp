// Commands that tell of all commands, by the descriptions that the command line is parsed by.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/config/study_reader.h"
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
  Offers offers;
  for (const CLI::App* command : app.get_subcommands({})) {
    offers.emplace_back(command->get_name(), command->get_description());
  }
  if (words.size() < 2) return offers;
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
  const std::vector<std::string> shells = {"bash", "zsh", "fish"};
  set_choices(*command.add_option("SHELL", *shell)->required(), shells);
  command.footer(
      "Examples:\n  eval \"$(npdr completion bash)\"\n"
      "  npdr completion fish > ~/.config/fish/completions/npdr.fish");
  return done_after([shell, shells] {
    const auto script = kScripts.find(*shell);
    if (script == kScripts.end()) throw InputError(unknown_name("shell", *shell, shells));
    fmt::print("{}", script->second);
  });
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
