/// Links between the documents, and within one, lead somewhere, and what they name exists.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <set>

#include "core/text.h"
#include "tests/architecture/source_root.h"

namespace npdr::architecture {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> documents() {
  std::vector<fs::path> files;
  for (const char* folder : {".", "docs", "experiments", "bench"}) {
    for (const auto& entry : fs::directory_iterator(kRoot / folder)) {
      if (entry.path().extension() == ".md") files.push_back(entry.path());
    }
  }
  return files;
}

// The lines outside of fenced blocks, joined: a link may go on in the next line.
std::string prose_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string text;
  bool is_code = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.find("```") != std::string::npos) {
      is_code = !is_code;
    } else if (!is_code) {
      text += line + "\n";
    }
  }
  return text;
}

// The anchor of a heading: lower case, punctuation left out, hyphens for blanks.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto letter = static_cast<unsigned char>(c);
    if (c == ' ') {
      anchor += '-';
    } else if (std::isalnum(letter) || c == '-' || c == '_') {
      anchor += static_cast<char>(std::tolower(letter));
    }
  }
  return anchor;
}

std::set<std::string> anchors_of(const fs::path& file) {
  std::set<std::string> anchors;
  std::istringstream stream(prose_of(file));
  const std::regex heading("#+ (.*)");
  std::smatch match;
  for (std::string line; std::getline(stream, line);) {
    if (std::regex_match(line, match, heading)) anchors.insert(anchor_of(match[1]));
  }
  return anchors;
}

// What the pattern's first group matches in the documents is there.
void expect_found(
    const std::regex& pattern, int at_least,
    const std::function<bool(const fs::path& file, const std::string& name)>& is_found) {
  std::vector<std::string> missing;
  int count = 0;
  for (const fs::path& file : documents()) {
    const std::string text = prose_of(file);
    for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i, ++count) {
      if (!is_found(file, (*i)[1]))
        missing.push_back(file.filename().string() + ": " + (*i).str(1));
    }
  }
  EXPECT_TRUE(missing.empty()) << join(missing, "\n");
  EXPECT_GT(count, at_least);
}

TEST(Documents, EveryLinkLeadsSomewhere) {
  const std::regex link(R"(\]\(([^)\s]+)\))");
  expect_found(link, 100, [](const fs::path& file, const std::string& target) {
    if (target.starts_with("http")) return true;
    const std::size_t hash = target.find('#');
    const std::string name = target.substr(0, hash);
    const fs::path to = name.empty() ? file : file.parent_path() / name;
    return fs::exists(to) && (hash == std::string::npos || to.extension() != ".md" ||
                              anchors_of(to).contains(target.substr(hash + 1)));
  });
}

// NAME stands for a name of the reader's.
TEST(Documents, EverySourceFileThatIsNamedExists) {
  const std::regex path(R"(`((?:core|sim|inference|analysis|pipeline|tests|scripts)/[\w./-]+)`)");
  expect_found(path, 50, [](const fs::path&, const std::string& name) {
    return name.find("NAME") != std::string::npos || fs::exists(kRoot / name);
  });
}

}  // namespace
}  // namespace npdr::architecture
