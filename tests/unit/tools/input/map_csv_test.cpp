#include "tests/unit/tools/input/temp_folder.hpp"
#include "tools/input/text_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string error_of(std::string_view text) {
  const auto rows = parse_map_csv(text, "m.csv");
  return rows ? "" : rows.error().message;
}

TEST(MapCsv, KeepsTheOrderOfTheFileAndIgnoresFurtherColumns) {
  const TempFolder folder;
  const auto rows = read_map_csv(folder.write("map.csv", "y_m,id,xi,x_m\n2,7,0,1\n-4.5,3,1,3.25\n"));
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->size(), 2U);
  EXPECT_EQ(rows->at(0).id, 7);
  EXPECT_EQ(rows->at(0).position_W, core::Point2(1, 2));
  EXPECT_EQ(rows->at(1).id, 3);
  EXPECT_EQ(rows->at(1).position_W, core::Point2(3.25, -4.5));
}

TEST(MapCsv, ADiameterMayBeThere) {
  const auto rows = parse_map_csv("id,x_m,y_m,diameter_m\n1,0,0,0.25\n2,1,0,\n3,2,0,0\n", "m.csv");
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_EQ(rows->at(0).diameter_m, 0.25);
  EXPECT_EQ(rows->at(1).diameter_m, 0.0);
  EXPECT_EQ(rows->at(2).diameter_m, 0.0);
}

TEST(MapCsv, SaysLineAndReasonOfARefusal) {
  EXPECT_THAT(error_of(""), HasSubstr("empty"));
  EXPECT_THAT(error_of("id,x_m,y_m\n"), HasSubstr("holds no landmark"));
  EXPECT_THAT(error_of("id,x_m\n1,2\n"), HasSubstr("no column y_m"));
  EXPECT_THAT(error_of("id,x_m,y_m\n1,0,0\n2,0,0\n1,5,5\n"),
              AllOf(HasSubstr("m.csv:4"), HasSubstr("line 2")));
  EXPECT_THAT(error_of("id,x_m,y_m\na,0,0\n"), HasSubstr("m.csv:2: id is 'a'"));
  EXPECT_THAT(error_of("id,x_m,y_m\n1,0,1e6\n"), HasSubstr("65000 m"));
  EXPECT_THAT(error_of("id,x_m,y_m,diameter_m\n1,0,0,-1\n"), HasSubstr("m.csv:2: diameter_m"));
}

}  // namespace
}  // namespace slamsensor::tools
