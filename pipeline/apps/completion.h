/// Completion of the words of `npdr` by shells.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace npdr::pipeline {

/// "bash", "zsh", "fish".
std::vector<std::string> completion_shells();

/// The script that makes `shell` complete the commands of `app`, their options, and values that are
/// one of a few (set_choices()). Throws InputError for another shell.
std::string completion_of(CLI::App& app, const std::string& shell);

}  // namespace npdr::pipeline
