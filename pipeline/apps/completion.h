/// Completion of the words of `npdr` by shells.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace npdr::pipeline {

/// The hidden command that the shells' lines call: `npdr __complete WORDS...`.
constexpr const char* kCompleteCommand = "__complete";

/// "bash", "zsh", "fish".
std::vector<std::string> completion_shells();

/// Lines that make `shell` ask for completions(). Throws InputError for another shell.
std::string completion_script(const std::string& shell);

/// Words that the last of `words`, those of a command line behind "npdr", may become, a line each,
/// with a tabulator and a description where there is one: commands of `app`, options of the
/// command, values that are one of a few (set_choices()), methods of the study that is named. None:
/// names of files, which shells complete.
std::string completions(CLI::App& app, const std::vector<std::string>& words);

}  // namespace npdr::pipeline
