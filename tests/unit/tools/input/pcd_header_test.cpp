#include "tools/input/pcd_header.hpp"

#include "tests/unit/tools/input/pcd_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The header of pcd_xyz(2, "ascii", "") with one line replaced; an empty `with` removes it.
std::string changed(const std::string& line, const std::string& with) {
  std::string text = pcd_xyz(2, "ascii", "");
  const std::size_t at = text.find("\n" + line + "\n") + 1;
  EXPECT_NE(at, 0U) << line;
  return text.replace(at, line.size() + 1, with.empty() ? "" : with + "\n");
}

std::string error_of(const std::string& text) {
  const auto header = parse_pcd_header(text, "c.pcd");
  return header ? "" : header.error().message;
}

TEST(PcdHeader, PlacesFieldsInAnyOrderAroundPadding) {
  const auto header = parse_pcd_header(
      pcd_file("ring _ z hist y x", "2 1 8 4 4 4", "U U F F F F", "1 3 1 5 1 1", 7, "binary", "rest"),
      "c.pcd");
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->points, 7U);
  EXPECT_EQ(header->stride_bytes, 2U + 3 + 8 + 20 + 4 + 4);
  EXPECT_EQ(header->values, 12U);
  EXPECT_EQ(header->fields[header->x].offset_bytes, 37U);
  EXPECT_EQ(header->fields[header->z].offset_bytes, 5U);
  EXPECT_EQ(header->fields[header->y].first_value, 10U);
  EXPECT_EQ(header->ring, 0U);
  EXPECT_EQ(header->data, PcdData::Binary);
}

TEST(PcdHeader, CountVersionAndViewpointMayBeMissingAndLinesEndInEitherWay) {
  const std::string text =
      "FIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nWIDTH 1\r\nHEIGHT 2\r\nPOINTS 2\r\nDATA ascii\r\n1 2 "
      "3\r\n";
  const auto header = parse_pcd_header(text, "c.pcd");
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(text.substr(header->data_offset_bytes), "1 2 3\r\n");
  EXPECT_EQ(header->data_line, 8U);
  EXPECT_FALSE(header->ring);
}

TEST(PcdHeader, RefusesMissingDoubledAndUnknownKeys) {
  for (const char* line : {"FIELDS x y z", "SIZE 4 4 4", "TYPE F F F", "WIDTH 2", "HEIGHT 1", "POINTS 2"}) {
    EXPECT_THAT(error_of(changed(line, "")), HasSubstr("has no " + std::string(line).substr(0, 4)));
  }
  EXPECT_THAT(error_of(changed("DATA ascii", "")), HasSubstr("no DATA line"));
  EXPECT_THAT(error_of(changed("HEIGHT 1", "WIDTH 2")),
              AllOf(HasSubstr("c.pcd:8"), HasSubstr("already in line 7")));
  EXPECT_THAT(error_of(changed("HEIGHT 1", "DEPTH 1")), HasSubstr("'DEPTH' is not a key"));
  EXPECT_THAT(error_of("\x89PNG\r\n\x1a\n"), HasSubstr("is this a PCD file?"));
  EXPECT_THAT(error_of(""), HasSubstr("no DATA line"));
}

TEST(PcdHeader, RefusesFieldsThatCannotBe) {
  EXPECT_THAT(error_of(changed("SIZE 4 4 4", "SIZE 4 4")), HasSubstr("SIZE has 2 values for 3 fields"));
  EXPECT_THAT(error_of(changed("COUNT 1 1 1", "COUNT 1 1 1 1")), HasSubstr("COUNT has 4 values"));
  EXPECT_THAT(error_of(changed("COUNT 1 1 1", "COUNT 1 0 1")), HasSubstr("'y' has COUNT 0"));
  EXPECT_THAT(error_of(changed("COUNT 1 1 1", "COUNT 1 -1 1")), HasSubstr("COUNT is '-1'"));
  EXPECT_THAT(error_of(changed("COUNT 1 1 1", "COUNT 1 2 1")), HasSubstr("'y' has COUNT 2"));
  EXPECT_THAT(error_of(changed("SIZE 4 4 4", "SIZE 4 3 4")), HasSubstr("type 'F' of size 3"));
  EXPECT_THAT(error_of(changed("SIZE 4 4 4", "SIZE 4 2 4")), HasSubstr("type 'F' of size 2"));
  EXPECT_THAT(error_of(changed("SIZE 4 4 4", "SIZE 4 -4 4")), HasSubstr("SIZE is '-4'"));
  EXPECT_THAT(error_of(changed("TYPE F F F", "TYPE F D F")), HasSubstr("type 'D'"));
  EXPECT_THAT(error_of(changed("FIELDS x y z", "FIELDS x y w")), HasSubstr("no field 'z'"));
  EXPECT_THAT(error_of(changed("FIELDS x y z", "FIELDS x z z")), HasSubstr("no field 'y'"));
  EXPECT_THAT(error_of(pcd_file("x y z z", "4 4 4 4", "F F F F", "1 1 1 1", 1, "ascii", "")),
              HasSubstr("'z' twice"));
}

TEST(PcdHeader, RefusesSizesThatContradictOrOverflow) {
  EXPECT_THAT(error_of(changed("POINTS 2", "POINTS 3")), HasSubstr("POINTS is 3, but WIDTH x HEIGHT is 2"));
  EXPECT_THAT(error_of(changed("POINTS 2", "POINTS 0")), HasSubstr("POINTS is 0, but WIDTH x HEIGHT is 2"));
  EXPECT_THAT(error_of(changed("WIDTH 2", "WIDTH 4294967297")), HasSubstr("WIDTH is '4294967297'"));
  EXPECT_THAT(error_of(changed("WIDTH 2", "WIDTH 18446744073709551617")), HasSubstr("WIDTH is"));
  EXPECT_THAT(error_of(changed("HEIGHT 1", "HEIGHT 1 1")), HasSubstr("HEIGHT has 2 values"));
  EXPECT_THAT(error_of(changed("HEIGHT 1", "HEIGHT")), HasSubstr("HEIGHT has 0 values"));
  EXPECT_THAT(error_of(changed("DATA ascii", "DATA zip")), HasSubstr("DATA is 'zip'"));
  EXPECT_THAT(error_of(changed("DATA ascii", "DATA")), HasSubstr("DATA is ''"));
}

TEST(PcdHeader, ReadsWordsInEitherCase) {
  const auto header = parse_pcd_header(
      "version 0.7\nfields X Y Z Ring\nsize 4 4 4 2\ntype f f f u\ncount 1 1 1 1\nwidth 1\nheight 1\n"
      "viewpoint 1 2 3 1 0 0 0\npoints 1\ndata BINARY_Compressed\n",
      "c.pcd");
  ASSERT_TRUE(header) << header.error().message;
  EXPECT_EQ(header->data, PcdData::BinaryCompressed);
  EXPECT_EQ(header->z, 2U);
  EXPECT_EQ(header->ring, 3U);
  EXPECT_EQ(header->T_cloud_L.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(error_of(changed("FIELDS x y z", "FIELDS x X z")), HasSubstr("'x' twice"));
}

TEST(PcdHeader, RefusesAViewpointThatIsNoPose) {
  const auto error_with = [](const std::string& values) {
    return error_of(changed("VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT" + values));
  };
  EXPECT_EQ(error_with(" -1e5 4.2e6 100 0.7071 0 0 -0.7071"), "");
  for (const char* values : {"", " 1 2 3", " 0 0 0 1 0 0 0 0"}) {
    EXPECT_THAT(error_with(values), AllOf(HasSubstr("c.pcd:9"), HasSubstr("must have seven"))) << values;
  }
  EXPECT_THAT(error_with(" 0 nan 0 1 0 0 0"), HasSubstr("'nan'"));
  EXPECT_THAT(error_with(" 0 0 1e9 1 0 0 0"), HasSubstr("'1e9'"));
  EXPECT_THAT(error_with(" 0 0 one 1 0 0 0"), HasSubstr("'one'"));
  EXPECT_THAT(error_with(" 0 0 0 0 0 0 0"), HasSubstr("has length 0"));
  EXPECT_THAT(error_with(" 0 0 0 1 1 0 0"), HasSubstr("has length 1.41421"));
}

TEST(PcdHeader, RefusesAHeaderWithoutEnd) {
  const std::string comment = "# " + std::string(kPcdHeaderBytesMax, 'c') + "\n";
  EXPECT_THAT(error_of(comment + pcd_xyz(2, "ascii", "")),
              HasSubstr("no DATA line in its first 65536 bytes"));
  std::string fields = "FIELDS";
  for (std::size_t i = 0; i <= kPcdFieldsMax; ++i) {
    fields += " f";
  }
  EXPECT_THAT(error_of(fields + "\n"), HasSubstr("more than 256 values"));
}

TEST(PcdHeader, ADataLineThatTheBoundCutsIsNotTaken) {
  std::string text = pcd_xyz(2, "binary_compressed", "12345678");
  const std::size_t until = text.find("binary_compressed") + std::string("binary").size();
  text.insert(0, "#" + std::string(kPcdHeaderBytesMax - until - 2, 'c') + "\n");
  ASSERT_EQ(text.substr(0, kPcdHeaderBytesMax).substr(kPcdHeaderBytesMax - 11), "DATA binary");
  EXPECT_THAT(error_of(text), HasSubstr("no DATA line"));
}

}  // namespace
}  // namespace slamsensor::tools
