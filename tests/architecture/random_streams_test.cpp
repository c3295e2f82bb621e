/// The list of random streams in docs/methods.md is that of the sources.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "core/text.h"
#include "tests/architecture/source_root.h"
#include "tests/temp_folder.h"

namespace npdr::architecture {
namespace {

namespace fs = std::filesystem;

// Names that follow a seed, or an identity that they are another purpose of.
std::set<std::string> stream_names() {
  const std::regex pattern(
      R"re((?:\b(?:named|within|of_\w+|stream_of|stream|spread|coverage_of)\([^"();=]*|[sS]eed(?!\w*_table)\w*(?:\(\))?,\s*|\{0,\s*|Stream = )"(\w+)")re");
  std::set<std::string> names;
  for (const char* folder : {"sim", "inference", "analysis", "pipeline"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      const std::string text = text_of(entry.path());
      for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i) {
        names.insert((*i)[1]);
      }
    }
  }
  return names;
}

TEST(RandomStreams, AreAllDocumented) {
  const std::string page = text_of(kRoot / "docs/methods.md");
  const std::string list = page.substr(page.find("## Random numbers\n"));
  std::vector<std::string> missing;
  for (const std::string& name : stream_names()) {
    if (list.find("`" + name + "`") == std::string::npos) missing.push_back(name);
  }
  EXPECT_TRUE(missing.empty()) << join(missing);
  EXPECT_GE(stream_names().size(), 50);
}

}  // namespace
}  // namespace npdr::architecture
