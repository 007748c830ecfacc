#include "tools/input/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace slamsensor::tools {
namespace {

TEST(Text, ReadsNumbersWholeOrNotAtAll) {
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number("+2e3"), 2000.0);
  EXPECT_EQ(parse_number("-0.25"), -0.25);
  EXPECT_TRUE(std::isnan(parse_number("nan").value()));
  EXPECT_TRUE(std::isinf(parse_number("-inf").value()));
  for (const char* text : {"", "+", "+-1", "1.5x", " 1", "1 ", "1,5", "0x10", "1e999", "."}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

TEST(Text, ReadsIntegersWholeOrNotAtAll) {
  EXPECT_EQ(parse_integer("007"), 7);
  EXPECT_EQ(parse_integer("-3"), -3);
  EXPECT_EQ(parse_integer("9223372036854775807"), 9223372036854775807);
  for (const char* text : {"", "1.0", "9223372036854775808", "1e3", "12a"}) {
    EXPECT_FALSE(parse_integer(text)) << text;
  }
}

TEST(Text, TakesWordsApart) {
  std::string_view rest = "  one\ttwo  three ";
  EXPECT_EQ(take_word(rest), "one");
  EXPECT_EQ(take_word(rest), "two");
  EXPECT_EQ(take_word(rest), "three");
  EXPECT_EQ(take_word(rest), "");
  EXPECT_EQ(take_word(rest), "");
}

TEST(Text, LinesKeepTheirNumbersPastCommentsBlanksAndBothLineEnds) {
  LineReader lines("\xEF\xBB\xBF# head\r\n\r\n one \r\n#two\nthree");
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.line(), "one");
  EXPECT_EQ(lines.number(), 3U);
  EXPECT_TRUE(lines.ended());
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.line(), "three");
  EXPECT_EQ(lines.number(), 5U);
  EXPECT_FALSE(lines.ended());
  EXPECT_FALSE(lines.next());
  EXPECT_FALSE(lines.next());
}

TEST(Text, ConsumedBytesPointBehindTheLine) {
  const std::string text = "a\nDATA binary\nrest";
  LineReader lines(text);
  ASSERT_TRUE(lines.next());
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(text.substr(lines.consumed_bytes()), "rest");
}

}  // namespace
}  // namespace slamsensor::tools
