#include "pipeline/sources/command_text.h"

#include <system_error>
#include <vector>

#include "pipeline/process/shell_text.h"

namespace npdr::pipeline {
namespace {

// Replaces every occurrence; false: there was none.
bool replace_all(std::string& text, const std::string& from, const std::string& to) {
  bool found = false;
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
    found = true;
  }
  return found;
}

constexpr const char* kSeparators = " \t\n;&|<>()=";

// Words between what separates words for a shell, without their quotes.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  std::string word;
  char quote = '\0';
  bool is_escaped = false;
  const auto end_word = [&] {
    if (!word.empty()) words.push_back(word);
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
    } else {
      word.push_back(c);
    }
  }
  end_word();
  return words;
}

// But for interpreters: programs in a folder `bin` elsewhere, of the system or an environment.
bool is_of_simulator(const std::string& word, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path path = folder / word;
  if (!fs::is_regular_file(path, error)) return false;
  const fs::path inside =
      fs::canonical(path, error).lexically_relative(fs::canonical(folder, error));
  const bool is_outside = inside.empty() || *inside.begin() == "..";
  return !(is_outside && path.lexically_normal().parent_path().filename() == "bin");
}

}  // namespace

std::string filled_command(const std::string& command, const std::filesystem::path& theta,
                           const std::filesystem::path& x) {
  std::string text = command;
  text.erase(text.find_last_not_of(" \t\n") + 1);
  const std::string theta_word = shell_word(theta), x_word = shell_word(x);
  if (!replace_all(text, "{theta}", theta_word)) text += " " + theta_word;
  if (!replace_all(text, "{x}", x_word)) text += " " + x_word;
  return text;
}

std::vector<std::string> named_paths(const std::string& command,
                                     const std::filesystem::path& folder) {
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

}  // namespace npdr::pipeline
