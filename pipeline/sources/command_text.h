/// The text of a simulator's command: what stands in it, and what it depends on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// The command with {theta} and {x} replaced by the paths of the files; a file whose placeholder
/// doesn't occur is appended, theta first.
std::string filled_command(const std::string& command, const std::filesystem::path& theta,
                           const std::filesystem::path& x);

/// Words of the command that are files, such as a script, by their paths from `folder`; but not
/// those that it writes (after '>') and, where they aren't in it, programs in a folder `bin`, such
/// as an environment's python3, and files of the machine (/usr, /etc, /tmp, ...).
std::vector<std::string> named_paths(const std::string& command,
                                     const std::filesystem::path& folder);

}  // namespace npdr::pipeline
