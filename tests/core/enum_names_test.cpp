#include "core/enum_names.h"

#include <gtest/gtest.h>

#include "tests/message_of.h"

namespace npdr {
namespace {

enum class Shape { square, disk, none };

constexpr auto enum_table(Shape) {
  return std::to_array<EnumRow<Shape>>(
      {{Shape::disk, "disk", "circle ball"}, {Shape::square, "square"}, {Shape::none, ""}});
}

TEST(EnumNames, EveryValueIsReadAsItIsWritten) {
  for (const Shape shape : {Shape::square, Shape::disk, Shape::none}) {
    EXPECT_EQ(value_named<Shape>(name_of(shape)), shape);
  }
}

TEST(EnumNames, OtherSpellingsAreReadAndNeverWritten) {
  EXPECT_EQ(value_named<Shape>("circle"), Shape::disk);
  EXPECT_EQ(value_named<Shape>("ball"), Shape::disk);
  EXPECT_EQ(value_named<Shape>("circle ball"), std::nullopt);
  EXPECT_EQ(name_of(Shape::disk), "disk");
}

TEST(EnumNames, KnowWhetherRowsAreInTheOrderOfTheirValues) {
  EXPECT_FALSE(is_in_order(enum_table(Shape{})));
  constexpr auto squares = std::to_array<EnumRow<Shape>>({{Shape::square, ""}, {Shape::disk, ""}});
  EXPECT_TRUE(is_in_order(squares));
}

TEST(EnumNames, KnowWhichNumbersHaveAValue) {
  EXPECT_TRUE(is_enumerator<Shape::none>());
  EXPECT_FALSE(is_enumerator<static_cast<Shape>(3)>());
}

TEST(EnumNames, ListsAreInTheTablesOrderWithoutNothing) {
  EXPECT_EQ(names_of<Shape>(), (std::vector<std::string>{"disk", "square"}));
}

TEST(EnumNames, AnUnknownNameIsAnErrorWithTheNearestOne) {
  EXPECT_EQ(message_of<InputError>([] { parse_enum<Shape>("shape", "sqare"); }),
            "unknown shape 'sqare' (did you mean 'square'?); known: disk, square");
}

}  // namespace
}  // namespace npdr
