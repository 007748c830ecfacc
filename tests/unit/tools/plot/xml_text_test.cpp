#include "tools/plot/svg.hpp"

#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

std::string escaped(std::string_view words) {
  std::string out;
  append_xml_text(out, words);
  return out;
}

TEST(XmlText, EscapesMarkup) {
  EXPECT_EQ(escaped("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
}

TEST(XmlText, KeepsUtf8) {
  EXPECT_EQ(escaped("\xCE\xBE \xE2\x80\x93 \xF0\x9F\x98\x80"), "\xCE\xBE \xE2\x80\x93 \xF0\x9F\x98\x80");
}

TEST(XmlText, ReplacesWhatIsNoXmlCharacter) {
  EXPECT_EQ(escaped(std::string_view("a\0b\x01"
                                     "c",
                                     5)),
            "a?b?c");
  EXPECT_EQ(escaped("\xFFz"), "?z");
  EXPECT_EQ(escaped("cut \xCE"), "cut ?");
  EXPECT_EQ(escaped("\xC0\xAF"), "??") << "longer than need be";
  EXPECT_EQ(escaped("\xED\xA0\x80"), "???") << "a surrogate";
  EXPECT_EQ(escaped("\xEF\xBF\xBF"), "???");
}

TEST(XmlText, WidthCountsCharactersNotBytes) {
  EXPECT_DOUBLE_EQ(text_width_px("\xCE\xBE", 10.0), text_width_px("x", 10.0));
  EXPECT_DOUBLE_EQ(text_width_px("00", 10.0), 2.0 * text_width_px("0", 10.0));
  EXPECT_EQ(text_width_px("", 10.0), 0.0);
}

TEST(XmlText, WrapsAtSpacesWithinTheWidth) {
  const std::vector<std::string> lines =
      wrap_text("one two  three four", 10.0, text_width_px("one two", 10.0));
  EXPECT_EQ(lines, (std::vector<std::string>{"one two", "three", "four"}));
}

TEST(XmlText, AWordWiderThanTheLineStandsAlone) {
  EXPECT_EQ(wrap_text("a enormous b", 10.0, 12.0), (std::vector<std::string>{"a", "enormous", "b"}));
  EXPECT_EQ(wrap_text("", 10.0, 12.0), (std::vector<std::string>{""}));
}

}  // namespace
}  // namespace slamsensor::tools
