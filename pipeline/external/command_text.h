/// The text of a simulator's command: what stands in it, and what it depends on.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace npdr::pipeline {

/// `word` as a shell reads it back: quoted where it needs it.
std::string shell_word(const std::string& word);

/// "npdr run study.toml --set 'a=b c'": words quoted for a shell where they need it.
std::string shell_text(const std::vector<std::string>& words);

/// The command with {theta} and {x} replaced by the paths of the files; a file whose placeholder
/// doesn't occur is appended, theta first.
std::string filled_command(const std::string& command, const std::filesystem::path& theta,
                           const std::filesystem::path& x);

/// Hashes of the files in `folder` that words of the command name, such as a script, by these
/// words.
std::map<std::string, std::string> named_files(const std::string& command,
                                               const std::filesystem::path& folder);

/// 32 hexadecimal digits of a file's bytes. Throws InputError when it can't be read.
std::string file_hash(const std::filesystem::path& path);

}  // namespace npdr::pipeline
