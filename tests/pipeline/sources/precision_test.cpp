#include "pipeline/sources/precision.h"

#include "core/constants.h"
#include "tests/message_of.h"
#include "tests/words_of.h"

namespace npdr::pipeline {
namespace {

const std::vector<Channel> kColumns = {{"far", "m"}, {"near", "m"}};

RowMatrix varying(double mean, double deviation) {
  RowMatrix x(20, 2);
  for (Index i = 0; i < x.rows(); ++i) {
    x.row(i) << mean + (i % 2 == 0 ? deviation : -deviation), static_cast<double>(i);
  }
  return x;
}

TEST(Precision, SaysWhichColumnsFloatsCantTellApart) {
  EXPECT_TRUE(says(words_of(find_lost_precision(varying(1e8, 1.5), kColumns)),
                   {"single precision", "'far' by 1.5 about 1e+08", "subtract an offset"}));
  EXPECT_FALSE(has(words_of(find_lost_precision(varying(1e8, 1.5), kColumns)), "'near'"));
  EXPECT_NE(words_of(find_lost_precision(varying(0.0, 1e-37), kColumns)), "");
  EXPECT_NE(words_of(find_lost_precision(varying(0.0, 1e-300), kColumns)), "")
      << "whose square is 0";
  RowMatrix partly_lost = varying(1e8, 1.5);
  partly_lost(3, 1) = kNaN;
  EXPECT_NE(words_of(find_lost_precision(partly_lost, kColumns)), "");
}

TEST(Precision, SaysNothingOfConstantsAndOfWhatFloatsHold) {
  EXPECT_EQ(words_of(find_lost_precision(varying(1e8, 1000.0), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.0, 1e-30), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.1, 0.0), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(0.1, 1e-16), kColumns)), "");
  EXPECT_EQ(words_of(find_lost_precision(varying(1e8, 1.5).topRows(7), kColumns)), "");
}

}  // namespace
}  // namespace npdr::pipeline
