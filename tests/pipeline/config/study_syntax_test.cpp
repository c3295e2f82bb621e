// Texts that are no study, or none that anybody means: hostile, endless, not TOML.
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "tests/pipeline/small_study.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(StudySyntax, OfManyTheFirstAreTold) {
  std::string unknown = "[evaluate]\n";
  for (int i = 0; i < 100'000; ++i) unknown += "k" + std::to_string(i) + " = 1\n";
  const std::string problems = problems_after("[prior]", unknown + "[prior]");
  EXPECT_EQ(std::ranges::count(problems, '\n'), 50);
  EXPECT_TRUE(problems.starts_with("s.toml:12:1: evaluate: unknown key 'k0'"));
  EXPECT_TRUE(problems.ends_with("\nand 99950 more problems"));
}

// Many texts in a row that differ by a number.
std::string numbered(int count, const std::string& before, const std::string& after) {
  std::string result;
  for (int i = 0; i < count; ++i) result += before + std::to_string(i) + after;
  return result;
}

TEST(StudySyntax, NobodyMeansMoreThanAThousandOfAKind) {
  EXPECT_TRUE(
      problems_after("[prior]", "[prior]\n" + numbered(1000, "a", " = { uniform = [0, 1] }\n"))
          .ends_with("must be of 1 to 1000 parameters"));
  EXPECT_TRUE(problems_after("pole_mass = 1.1", numbered(1000, "a", " = 1, ") + "pole_mass = 1.1")
                  .ends_with("must be of at most 1000 numbers"));
  EXPECT_EQ(problems_of(kStudyText + numbered(999, "[[method]]\nfoo = ", "\n")),
            "s.toml:15:1: method is there 1001 times, must be at most 1000");
}

TEST(StudySyntax, ALibrarysSettingsAreReadAtOnceHoweverMany) {
  const std::string library =
      "library = \"no.so\"\nsettings = { " + numbered(200'000, "k", " = 1, ");
  EXPECT_NE(problems_after("name = \"pendulum\"", library + "end = 1 }"), "");
}

TEST(StudySyntax, HostileFilesAreRefused) {
  const TempFolder folder;
  const auto read = [&](const std::filesystem::path& path) {
    return message_of<InputError>([&] { read_study(path); }, &folder);
  };
  EXPECT_TRUE(says(read(folder / "missing.toml"),
                   {"missing.toml: can't be opened", "does it exist and may you read it?"}));
  std::filesystem::create_directory(folder / "folder.toml");
  EXPECT_TRUE(
      says(read(folder / "folder.toml"), {"folder.toml: is a folder", "must be a study file"}));
  EXPECT_EQ(read(folder.file("big.toml", std::string(10'000'001, '#'))),
            "big.toml: is larger than 10 MB: not a study file");
  EXPECT_EQ(read("/dev/zero"), "/dev/zero: is larger than 10 MB: not a study file");
  EXPECT_EQ(read(folder.file("binary.toml", std::string("\x7f"
                                                        "ELF\x02\x01\0\0",
                                                        8)))
                .substr(0, 17),
            "binary.toml:1:1: ");
  std::string deep;
  for (int i = 0; i < 200'000; ++i) deep += "a.";
  EXPECT_TRUE(says(read(folder.file("deep.toml", deep + "a = 1")),
                   {"deep.toml: holds 200000 dots", "4999"}));
  EXPECT_EQ(read(folder.file("nested.toml", "a = " + std::string(100'000, '['))).substr(0, 13),
            "nested.toml:1");
}

TEST(StudySyntax, QuotesOfLongValuesAreCut) {
  EXPECT_EQ(quoted(std::string(100, 'a')), "'" + std::string(60, 'a') + "...'");
  EXPECT_EQ(quoted("a\tb"), "'a?b'");
  EXPECT_EQ(shortened(std::string(59, 'a') + "\xC3\xA9\xC3\xA9"), std::string(59, 'a') + "...");
}

TEST(StudySyntax, ManyDotsThatAreAllowedDontOverflowTheStack) {
  std::string deep;
  for (int i = 0; i < 4'999; ++i) deep += "a.";
  EXPECT_TRUE(has(problems_of(deep + "a = 1"), "unknown key 'a'"));
  std::string digits;  // as many dots as may look like a number's
  for (int i = 0; i < 4'998; ++i) digits += "1.1 . ";
  EXPECT_TRUE(has(problems_of(digits + "a = 1"), "unknown key '1'"));
  EXPECT_TRUE(has(problems_of(digits + ". . a = 1"), "holds 5000 dots"));
  std::string numbers;
  for (int i = 0; i < 20'000; ++i) numbers += "[0.25, -1.5e3],";
  EXPECT_TRUE(has(problems_of("a = [" + numbers + "]"), "unknown key 'a'"));
  EXPECT_TRUE(has(problems_of(kStudyText, {deep.substr(0, 2000) + "a=1"}), "unknown key 'a'"));
  EXPECT_TRUE(has(problems_of(kStudyText, {deep.substr(0, 2002) + "a=1"}), "holds 1001 dots"));
}

}  // namespace
}  // namespace npdr::pipeline
