/// Golden files: cases "input -> what is said of it", for people to read in a diff.
///
///   # comment
///   == name                 a text, up to "==": what the cases below it begin with
///   ...
///   ==
///   from => to              a case: lines of input from the first column,
///     what is said of it    and behind them what is said, indented by two; "fine": nothing
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr {

struct GoldenCase {
  std::string name, text;          ///< of the text above
  std::vector<std::string> input;  ///< its lines
};

/// `text` with all `from` replaced by `to`.
inline std::string with_all(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// `text` after an edit, a line of input "from => to" in which "\n" ends lines; "=> to" adds to its
/// end.
inline std::string edited(const std::string& text, const std::string& edit) {
  if (edit.starts_with("=> ")) return text + with_all(edit.substr(3), "\\n", "\n") + "\n";
  const std::size_t arrow = edit.find(" =>");
  EXPECT_NE(arrow, std::string::npos) << "no edit: " << edit;
  if (arrow == std::string::npos) return text;
  const std::string to = edit.substr(std::min(arrow + 4, edit.size()));
  return edited(text, with_all(edit.substr(0, arrow), "\\n", "\n"), with_all(to, "\\n", "\n"));
}

/// A golden file as it is, and as it would be with what is said now.
class GoldenFile {
 public:
  using Say = std::function<std::string(const GoldenCase&)>;

  GoldenFile(std::filesystem::path path, Say say) : path_(std::move(path)), say_(std::move(say)) {
    std::istringstream stream(text_of(path_));
    for (std::string line; std::getline(stream, line);) lines_.push_back(line);
  }

  /// Expects each case to say what the file says; rewrites the file where NPDR_REWRITE_GOLDEN is
  /// set.
  void expect_unchanged() {
    EXPECT_FALSE(lines_.empty()) << path_;
    while (at_ < lines_.size()) {
      if (line().starts_with("== ")) {
        read_text();
      } else if (is_input()) {
        run_case();
      } else {
        keep();
      }
    }
    if (std::getenv("NPDR_REWRITE_GOLDEN") != nullptr && now_ != text_of(path_)) {
      std::ofstream(path_, std::ios::binary) << now_;
    }
  }

 private:
  const std::string& line() const { return lines_[at_]; }
  bool is_input() const {
    return at_ < lines_.size() && !line().empty() && line()[0] != ' ' && line()[0] != '#' &&
           !line().starts_with("==");
  }
  const std::string& keep() {
    now_ += line() + "\n";
    return lines_[at_++];
  }

  void read_text() {
    case_.name = keep().substr(3);
    case_.text.clear();
    while (at_ < lines_.size() && line() != "==") case_.text += keep() + "\n";
    if (at_ < lines_.size()) keep();
  }

  void run_case() {
    const auto begin = static_cast<int>(at_) + 1;
    case_.input.clear();
    while (is_input()) case_.input.push_back(keep());
    std::string before;
    while (at_ < lines_.size() && line().starts_with("  ")) before += lines_[at_++] + "\n";
    const std::string said = say_(case_);
    const std::string now = "  " + with_all(said.empty() ? "fine" : said, "\n", "\n  ") + "\n";
    now_ += now;
    if (now == before) return;
    ADD_FAILURE_AT(path_.c_str(), begin) << "said now:\n"
                                         << now << "before:\n"
                                         << before << "If it should, run scripts/golden.";
  }

  std::filesystem::path path_;
  Say say_;
  std::vector<std::string> lines_;
  std::size_t at_ = 0;
  GoldenCase case_;
  std::string now_;
};

/// Tests the cases of tests/golden/`subject`.txt: `say` gives what is said of one now.
inline void expect_golden(const std::string& subject, const GoldenFile::Say& say) {
  GoldenFile(std::filesystem::path(NPDR_SOURCE_DIR) / "tests/golden" / (subject + ".txt"), say)
      .expect_unchanged();
}

}  // namespace npdr
