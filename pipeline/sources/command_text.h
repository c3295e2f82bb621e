/// The text of a simulator's command: what stands in it, and what it depends on.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace npdr::pipeline {

/// The command with {theta} and {x} replaced by the paths of the files; a file whose placeholder
/// doesn't occur is appended, theta first.
std::string filled_command(const std::string& command, const std::filesystem::path& theta,
                           const std::filesystem::path& x);

/// Hashes of the files in `folder` that words of the command name, such as a script, by these
/// words. Throws InputError when one can't be read.
std::map<std::string, std::string> named_files(const std::string& command,
                                               const std::filesystem::path& folder);

}  // namespace npdr::pipeline
