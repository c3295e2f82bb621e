/// What the words of a simulator's command tell of whether it can be run, without running it.
#pragma once

#include <filesystem>
#include <string>

namespace npdr::pipeline {

/// Why a command for a shell can't be run in `folder`: the program that it begins with has a path
/// and isn't there or may not be executed, or is an interpreter whose script isn't there. Empty
/// where nothing of that kind is certain: words with quotes, variables or options are left to the
/// shell.
std::string program_fault(const std::string& command, const std::filesystem::path& folder);

/// The program that a command begins with where it is a mere name and no shell of this machine
/// finds it; else empty. Another machine may.
std::string unknown_program(const std::string& command);

}  // namespace npdr::pipeline
