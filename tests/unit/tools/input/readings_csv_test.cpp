#include "core/config.hpp"
#include "core/detection/levelling.hpp"
#include "tools/input/text_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string error_of(std::string_view text) {
  const auto scanlines = parse_readings_csv(text, "r.csv");
  return scanlines ? "" : scanlines.error().message;
}

TEST(ReadingsCsv, RowsThatShareATiltAsWrittenAreAScanline) {
  const auto scan =
      parse_readings_csv("pan_deg,tilt_deg,range_m\n10,0,5\n20,0,\n30,0.0,7\n20,1,8\n10,0,9\n", "r.csv");
  ASSERT_TRUE(scan);
  const auto& scanlines = scan->scanlines;
  ASSERT_EQ(scanlines.size(), 4U);
  ASSERT_EQ(scanlines[0].size(), 2U);
  EXPECT_DOUBLE_EQ(scanlines[0][0].pan_rad, 10 * core::kDegree);
  EXPECT_EQ(scanlines[0][0].range_m, 5.0);
  EXPECT_FALSE(scanlines[0][1].has_return());
  EXPECT_EQ(scanlines[1][0].range_m, 7.0);
  EXPECT_DOUBLE_EQ(scanlines[2][0].tilt_rad, core::kDegree);
  EXPECT_EQ(scanlines[3][0].range_m, 9.0);
  EXPECT_EQ(scan->zero_ranges, 0U) << "an empty range is no zero";
}

TEST(ReadingsCsv, UnderstandsOtherOrdersOfColumnsMarkAndLineEnds) {
  const auto scan = parse_readings_csv(
      "\xEF\xBB\xBFrange_m,pan_deg,tilt_deg\r\n# c\r\n,-180,-30\r\n0.5,360,-30\r\n", "r.csv");
  ASSERT_TRUE(scan);
  ASSERT_EQ(scan->scanlines.size(), 1U);
  EXPECT_FALSE(scan->scanlines[0][0].has_return());
  EXPECT_TRUE(scan->scanlines[0][1].has_return());
  EXPECT_DOUBLE_EQ(scan->scanlines[0][1].pan_rad, 360 * core::kDegree);
}

// Devices that write 0 or -1 for "nothing" stood in a ring of landmarks at their own place.
TEST(ReadingsCsv, ARangeOfZeroOrLessIsNoReturnAndCounted) {
  const auto scan = parse_readings_csv(
      "pan_deg,tilt_deg,range_m\n0,0,0\n1,0,0.000\n2,0,-1\n3,0,\n4,0,0.2\n5,0,-0.5\n", "r.csv");
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->zero_ranges, 4U);
  for (const std::size_t i : {0U, 1U, 2U, 3U, 5U}) {
    EXPECT_FALSE(scan->scanlines[0][i].has_return()) << i;
  }
  EXPECT_TRUE(scan->scanlines[0][4].has_return());
}

/// 6 tilts of 30 readings, rearranged: row i of the file is row `at(i)` of the sweep.
template <typename At>
std::string sweep(const At& at) {
  std::string text = "pan_deg,tilt_deg,range_m\n";
  for (int i = 0; i < 180; ++i) {
    const int row = at(i);
    const int line = row / 30;
    const int pan = line % 2 == 0 ? row % 30 : 29 - row % 30;
    text += std::to_string(pan) + ',' + std::to_string(line) + ",5.25\n";
  }
  return text;
}

TEST(ReadingsCsv, ReadingsInNoOrderOfASweepAreTold) {
  const auto remark_of = [](const std::string& text) { return parse_readings_csv(text, "r.csv")->remark; };
  EXPECT_EQ(remark_of(sweep([](int i) { return i; })), "") << "to and fro";
  EXPECT_EQ(remark_of(sweep([](int i) { return i < 90 ? i + 90 : i - 90; })), "") << "tilts in another order";
  EXPECT_THAT(remark_of(sweep([](int i) { return i * 77 % 180; })),
              AllOf(HasSubstr("r.csv"), HasSubstr("order of the rows matters")))
      << "all mixed";
  EXPECT_THAT(remark_of(sweep([](int i) { return i % 6 * 30 + i / 6; })),
              HasSubstr("6 tilts change 180 times"))
      << "column by column";
  EXPECT_THAT(remark_of(sweep([](int i) { return i / 30 * 30 + i * 7 % 30; })),
              HasSubstr("the pan turns back"))
      << "mixed within the lines";
}

TEST(ReadingsCsv, SaysLineValueAndWhatIsAllowed) {
  const std::string head = "pan_deg,tilt_deg,range_m\n";
  EXPECT_THAT(error_of(""), HasSubstr("empty"));
  EXPECT_THAT(error_of(head), HasSubstr("holds no reading"));
  EXPECT_THAT(error_of(head + "0,0,x\n"), AllOf(HasSubstr("r.csv:2"), HasSubstr("range_m is 'x'"),
                                                HasSubstr("nothing when nothing came back")));
  EXPECT_THAT(error_of(head + "0,0,nan\n"), HasSubstr("'nan'"));
  EXPECT_THAT(error_of(head + "0,0,inf\n"), HasSubstr("'inf'"));
  EXPECT_THAT(error_of(head + "0,0,65535\n"), HasSubstr("10000 m"));
  EXPECT_THAT(error_of(head + "361,0,1\n"), HasSubstr("-360 to 360 deg"));
  EXPECT_THAT(error_of(head + "0,91,1\n"), HasSubstr("-90 to 90 deg"));
  EXPECT_THAT(error_of(head + ",0,1\n"), HasSubstr("pan_deg is ''"));
  EXPECT_THAT(error_of(head + "0,0,1;\n"), HasSubstr("'1;'"));
  EXPECT_THAT(error_of(head + "0,0,1\n0,0\n"), AllOf(HasSubstr("r.csv:3"), HasSubstr("2 fields")));
  EXPECT_THAT(error_of("pan_deg,tilt_deg,range_m,intensity\n"), HasSubstr("'intensity' is not known"));
  EXPECT_THAT(error_of("pan_deg,range_m\n"), HasSubstr("no column tilt_deg"));
}

TEST(ReadingsCsv, RollAndPitchOfARowLevelItsReading) {
  const auto got = parse_readings_csv(
      "pan_deg,tilt_deg,range_m,roll_deg,pitch_deg\n90,0,5,5,0\n0,0,,0,-3\n10,-2,7,3,4\n", "r.csv");
  ASSERT_TRUE(got) << got.error().message;
  EXPECT_EQ(got->scanlines.size(), 2U) << "scanlines are those of the head's tilt";
  EXPECT_NEAR(got->scanlines.at(0)[0].tilt_rad, 5 * core::kDegree, 1e-12);
  EXPECT_NEAR(got->scanlines.at(0)[1].tilt_rad, 3 * core::kDegree, 1e-12);
  EXPECT_FALSE(got->scanlines.at(0)[1].has_return());
  const core::Reading expected =
      core::Levelling({3 * core::kDegree, 4 * core::kDegree})({10 * core::kDegree, -2 * core::kDegree, 7.0});
  EXPECT_EQ(got->scanlines.at(1)[0].pan_rad, expected.pan_rad);
  EXPECT_EQ(got->scanlines.at(1)[0].tilt_rad, expected.tilt_rad);
}

TEST(ReadingsCsv, SettingsLevelAFileThatHoldsNoAttitude) {
  firmware::LevellingConfig levelling;
  levelling.fixed = {5 * core::kDegree, 0.0};
  const std::string text = "pan_deg,tilt_deg,range_m\n90,0,5\n";
  EXPECT_EQ(parse_readings_csv(text, "r.csv", levelling)->scanlines.at(0)[0].tilt_rad, 0.0)
      << "source is none";
  levelling.source = firmware::InclinationSource::Fixed;
  EXPECT_NEAR(parse_readings_csv(text, "r.csv", levelling)->scanlines.at(0)[0].tilt_rad, 5 * core::kDegree,
              1e-12);
  const std::string own = "pan_deg,tilt_deg,range_m,roll_deg,pitch_deg\n90,0,5,2,0\n";
  EXPECT_NEAR(parse_readings_csv(own, "r.csv", levelling)->scanlines.at(0)[0].tilt_rad, 2 * core::kDegree,
              1e-12);
  levelling.source = firmware::InclinationSource::Can;
  EXPECT_TRUE(parse_readings_csv(own, "r.csv", levelling));
  const auto refused = parse_readings_csv(text, "r.csv", levelling);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("r.csv"), HasSubstr("inclination.source")));
}

TEST(ReadingsCsv, RollAndPitchComeTogetherAndInBounds) {
  EXPECT_THAT(error_of("pan_deg,tilt_deg,range_m,roll_deg\n0,0,1,0\n"), HasSubstr("both or none"));
  EXPECT_THAT(error_of("pan_deg,tilt_deg,range_m,roll_deg,pitch_deg\n0,0,1,181,0\n"),
              AllOf(HasSubstr("r.csv:2"), HasSubstr("roll_deg is '181'")));
  EXPECT_THAT(error_of("pan_deg,tilt_deg,range_m,roll_deg,pitch_deg\n0,0,1,0,\n"),
              HasSubstr("pitch_deg is ''"));
}

}  // namespace
}  // namespace slamsensor::tools
