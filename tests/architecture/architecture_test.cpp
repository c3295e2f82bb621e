/// The source tree as it is keeps to the rules.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>

#include "core/text.h"
#include "tests/architecture/include_rules.h"
#include "tests/architecture/source_root.h"

namespace npdr::architecture {
namespace {

// The folders that the project is built from, in the words of its own CMakeLists.txt.
std::vector<std::string> built_folders() {
  const std::regex pattern(R"(\s*add_subdirectory\((\w+)\).*)");
  std::ifstream stream(kRoot / "CMakeLists.txt");
  std::vector<std::string> folders;
  std::smatch match;
  for (std::string line; std::getline(stream, line);) {
    if (std::regex_match(line, match, pattern)) folders.push_back(match[1]);
  }
  return folders;
}

TEST(Architecture, IncludesFollowTheDataFlow) {
  const std::vector<std::string> broken = broken_rules(kRoot);
  EXPECT_TRUE(broken.empty()) << join(broken, "\n");
}

TEST(Architecture, EverySourceIncludesItsOwnHeaderFirst) {
  const std::vector<std::string> late = late_own_headers(kRoot);
  EXPECT_TRUE(late.empty()) << join(late, "\n");
}

TEST(Architecture, TheRulesKnowEveryFolderThatIsBuilt) {
  std::vector<std::string> expected = known_folders();
  expected.insert(expected.end(), {"tests", "bench"});
  EXPECT_EQ(built_folders(), expected);
}

TEST(Architecture, TheRulesKnowEveryLayerOfThePipeline) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(kRoot / "pipeline")) {
    if (entry.is_directory()) found.push_back(entry.path().filename().string());
  }
  std::vector<std::string> expected = known_layers();
  std::ranges::sort(found);
  std::ranges::sort(expected);
  EXPECT_EQ(found, expected);
}

// The rules would also hold if they saw no includes at all.
TEST(Architecture, EverySiblingIsSeenToIncludeCore) {
  for (const std::string folder : {"sim", "inference", "analysis"}) {
    const std::vector<Include> includes = includes_below(kRoot, folder);
    EXPECT_TRUE(std::any_of(includes.begin(), includes.end(), [](const Include& include) {
      return include.path == "core/error.h";
    })) << folder;
  }
}

}  // namespace
}  // namespace npdr::architecture
