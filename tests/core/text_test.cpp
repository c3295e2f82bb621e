#include "core/text.h"

#include <gtest/gtest.h>

#include "tests/message_of.h"

namespace npdr {
namespace {

TEST(Text, FindsTheNearestName) {
  const std::vector<std::string> names = {"learning_rate", "batch_size", "clip_norm"};
  EXPECT_EQ(nearest_name("learning_rat", names), "learning_rate");
  EXPECT_EQ(nearest_name("Batch_Size", names), "batch_size");
  EXPECT_EQ(nearest_name("wholly_different", names), "");
  EXPECT_EQ(nearest_name("x0", {"zz", "x1"}), "x1");
  EXPECT_EQ(nearest_name("x", {"a"}), "") << "another name altogether";
  EXPECT_EQ(nearest_name("npe", {"nle", "npe_c"}), "npe_c") << "a name cut short";
  EXPECT_EQ(nearest_name("NPE", {"nle", "npe_c"}), "npe_c");
  EXPECT_EQ(nearest_name("theta", {"thet", "theta_dot"}), "thet") << "a letter is missing";
  EXPECT_EQ(nearest_name("np", {"nle", "npe_c"}), "") << "too short to tell";
}

TEST(Text, UnknownNameListsWhatIsKnown) {
  EXPECT_TRUE(says(unknown_name("simulator", "furta", {"furuta", "pendulum"}),
                   {"unknown simulator 'furta'", "'furuta'", "known: furuta, pendulum"}));
}

TEST(Text, SplitsAtASeparator) {
  EXPECT_EQ(split("a::b", ':'), (std::vector<std::string>{"a", "", "b"}));
  EXPECT_TRUE(split("", ':').empty());
}

TEST(Text, ListsNames) {
  EXPECT_EQ(listed({}), "");
  EXPECT_EQ(listed({"a"}), "a");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

TEST(Text, CountsAThing) {
  EXPECT_EQ(counted(0, "seed"), "0 seeds");
  EXPECT_EQ(counted(1, "seed"), "1 seed");
  EXPECT_EQ(counted(2, "seed"), "2 seeds");
}

TEST(Text, CountsAreDigitsOnly) {
  EXPECT_EQ(parse_count("17"), 17);
  for (const char* text : {"", "-1", "-0", "+1", "1 ", "0x1", "1.5", "99999999999999999999"}) {
    EXPECT_FALSE(parse_count(text)) << text;
  }
}

}  // namespace
}  // namespace npdr
