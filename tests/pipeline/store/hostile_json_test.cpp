#include "pipeline/store/hostile_json.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

std::string refusal_of(const std::string& text) {
  return message_of<InputError>([&] { parse_json(text, "a.h5"); });
}

TEST(HostileJson, ThatWouldEndTheProcessIsRefused) {
  const std::string nested(100'000, '[');
  EXPECT_TRUE(says(refusal_of(nested), {"a.h5: its JSON nests too deeply"}));
  EXPECT_FALSE(json_in(nested));
  const auto nested_by = [](int depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_TRUE(json_in(nested_by(500)));
  EXPECT_FALSE(json_in(nested_by(501)));
}

TEST(HostileJson, MayHoldBracketsInItsTexts) {
  const std::string text = R"(["\"\\)" + std::string(1000, '[') + "\"]";
  EXPECT_EQ(parse_json(text, "a.h5").size(), 1u);
}

TEST(HostileJson, ThatIsNoneIsRefused) {
  EXPECT_TRUE(says(refusal_of("{'a'}"), {"a.h5: ", "{'a'}", "isn't JSON"}));
  EXPECT_FALSE(json_in("{'a'}"));
}

}  // namespace
}  // namespace npdr::pipeline
