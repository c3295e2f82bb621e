#include "pipeline/config/study_check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <string_view>
#include <system_error>

#include "core/shell_call.h"
#include "core/text.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

bool is_plain(const std::string& word) {
  return std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("_./+-").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

// The first two words; the second is empty where no more than the first means what it says.
std::array<std::string, 2> first_words(const std::string& command) {
  std::istringstream stream(command);
  std::array<std::string, 2> words;
  for (std::string& word : words) {
    if (stream >> word && is_plain(word)) continue;
    word.clear();
    break;
  }
  return words;
}

// "python3.11" of "/usr/bin/python3.11" is "python".
bool reads_scripts(const fs::path& program) {
  constexpr std::array interpreters = {"python", "pypy",    "sh",    "bash", "dash",
                                       "zsh",    "Rscript", "julia", "perl", "ruby"};
  std::string name = program.filename();
  name.erase(name.find_last_not_of("0123456789.") + 1);
  return std::ranges::find(interpreters, name) != interpreters.end();
}

bool has_folder(const std::string& program) { return program.find('/') != std::string::npos; }

// Whether a shell finds a program, a builtin or a keyword of that name.
bool is_known(const std::string& name) {
  constexpr double seconds = 10.0;
  return run_shell({{"command -v " + name, ".", {}}, seconds}).succeeded();
}

bool is_missing(const fs::path& file) {
  std::error_code error;
  return fs::status(file, error).type() == fs::file_type::not_found;
}

}  // namespace

std::string program_fault(const std::string& command, const fs::path& folder) {
  const auto [program, script] = first_words(command);
  const auto no_file = [&](const std::string& name) {
    return fmt::format("there is no {} in the folder {}", quoted(name), quoted(folder));
  };
  if (has_folder(program) && is_missing(folder / program)) return no_file(program);
  if (has_folder(program) && access((folder / program).c_str(), X_OK) != 0) {
    return fmt::format("{} may not be executed (chmod +x)", quoted(program));
  }
  const bool is_option = script.starts_with('-') || script.starts_with('+');
  const bool is_script = reads_scripts(program) && !script.empty() && !is_option;
  // Shells look for scripts on the PATH, too.
  if (is_script && is_missing(folder / script) && !is_known(script)) return no_file(script);
  return "";
}

std::string unknown_program(const std::string& command) {
  const std::string program = first_words(command).front();
  return program.empty() || has_folder(program) || is_known(program) ? "" : program;
}

}  // namespace npdr::pipeline
