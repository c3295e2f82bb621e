#include "pipeline/sources/program_call.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/process/child_process.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSeparators = " \t\n;&|<>()=";

// Words between what separates words for a shell, without their quotes, but for files that are
// written: after '>'.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  std::string word;
  char quote = '\0';
  bool is_escaped = false;
  bool is_output = false;
  const auto end_word = [&] {
    if (!word.empty() && !is_output) words.push_back(word);
    is_output = is_output && word.empty();
    word.clear();
  };
  for (const char c : command) {
    if (is_escaped) {
      const bool is_kept = quote == '"' && std::string("$`\"\\\n").find(c) == std::string::npos;
      word += is_kept ? std::string{'\\', c} : std::string{c};
      is_escaped = false;
    } else if (c == '\\' && quote != '\'') {
      is_escaped = true;
    } else if (quote != '\0') {
      c == quote ? void(quote = '\0') : word.push_back(c);
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (std::string(kSeparators).find(c) != std::string::npos) {
      end_word();
      is_output = is_output || c == '>';
    } else {
      word.push_back(c);
    }
  }
  end_word();
  return words;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  const auto inside = path.lexically_normal().lexically_relative(folder.lexically_normal());
  return !inside.empty() && *inside.begin() != "..";
}

// Of the machine, not of a simulator: its system, its devices and, unless the study itself lies
// there, what programs leave for a while.
bool is_of_machine(const fs::path& path, const fs::path& folder) {
  const auto holds_it = [&](const fs::path& place) { return is_below(path, place); };
  if (std::ranges::any_of(std::array{"/dev", "/proc", "/sys", "/run", "/etc", "/usr", "/var"},
                          holds_it)) {
    return true;
  }
  std::error_code none;
  const fs::path temporary = fs::temp_directory_path(none);
  return is_below(path, temporary) && !is_below(folder, temporary);
}

// But for interpreters: programs in a folder `bin` elsewhere, of the system or an environment.
bool is_of_simulator(const std::string& word, const fs::path& folder) {
  std::error_code error;
  const fs::path path = folder / word;
  if (!fs::is_regular_file(path, error)) return false;
  // By its name or, where that leads through links, by where it lies.
  if (is_below(path, folder) ||
      is_below(fs::canonical(path, error), fs::canonical(folder, error))) {
    return true;
  }
  if (fs::path(word).is_absolute() && is_of_machine(path, folder)) return false;
  return path.lexically_normal().parent_path().filename() != "bin";
}

// The folder of npdr_worker.py and npdr_command.py, beside that of the executables, before what it
// is already.
std::string python_path() {
  std::string path = (executable_folder().parent_path() / "lib").string();
  const char* const own = std::getenv("PYTHONPATH");
  return own == nullptr || *own == '\0' ? path : path + ":" + own;
}

}  // namespace

std::vector<std::string> named_paths(const std::string& command, const fs::path& folder) {
  std::vector<std::string> named;
  std::vector<std::string> words = words_of(command);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word = words[i];
    if (is_of_simulator(word, folder)) {
      named.push_back(word);
    } else if (word.find_first_of(kSeparators) != std::string::npos) {
      // A command itself, for `sh -c`; its words are shorter.
      const std::vector<std::string> inner = words_of(word);
      words.insert(words.end(), inner.begin(), inner.end());
    }
  }
  return named;
}

FileHashes::FileHashes(const std::vector<std::string>& names, const fs::path& folder)
    : folder_(folder) {
  for (const std::string& name : names) {
    stamps_[name] = stamp_of(folder / name);  // first: an edit in between is looked at again
    hashes_[name] = file_hash(folder / name);
  }
}

void FileHashes::require_unchanged() {
  for (auto& [name, stamp] : stamps_) {
    const fs::path path = folder_ / name;
    std::error_code error;
    const bool is_gone = !fs::exists(path, error);
    if (error) continue;
    const Stamp now = stamp_of(path);
    if (!is_gone && now == stamp) continue;
    if (is_gone || file_hash(path) != hashes_.at(name)) {
      throw Error(fmt::format(
          "{} {} since this began: rows that were simulated with it meanwhile are thrown away; "
          "run again, with the file as it was to go on, or as it is now to begin anew",
          path.string(), is_gone ? "is gone" : "was edited"));
    }
    stamp = now;
  }
}

FileHashes::Stamp FileHashes::stamp_of(const fs::path& path) {
  std::error_code ignored;
  return {fs::last_write_time(path, ignored), fs::file_size(path, ignored)};
}

std::string Program::words() const {
  return external.worker ? fmt::format("simulator.worker = '{}'", *external.worker)
                         : fmt::format("simulator.command = '{}'", *external.command);
}

ShellCommand Program::shell_command(const std::string& text) const {
  return {text,
          external.folder,
          {{"PYTHONPATH", python_path()}, {"OMP_NUM_THREADS", std::to_string(threads)}}};
}

std::string filled_command(const std::string& command, const std::filesystem::path& theta,
                           const std::filesystem::path& x) {
  std::string text = command;
  text.erase(text.find_last_not_of(" \t\n") + 1);
  for (const auto& [place, path] : {std::pair("{theta}", theta), std::pair("{x}", x)}) {
    const bool has_place = text.find(place) != std::string::npos;
    text = has_place ? replaced_all(text, place, shell_word(path)) : text + " " + shell_word(path);
  }
  return text;
}

}  // namespace npdr::pipeline
