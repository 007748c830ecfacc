#include "tools/input/scan_names.hpp"

#include "tools/input/scan_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

using std::chrono::nanoseconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using Paths = std::vector<std::filesystem::path>;

std::vector<std::int64_t> numbers(const Paths& files) {
  const auto labels = label_scans(files);
  EXPECT_TRUE(labels) << labels.error().message;
  std::vector<std::int64_t> result;
  for (const ScanLabel& label : labels->labels) {
    result.push_back(label.number);
  }
  return result;
}

std::vector<std::int64_t> times_ns(const Paths& files) {
  const auto labels = label_scans(files);
  EXPECT_TRUE(labels) << labels.error().message;
  std::vector<std::int64_t> result;
  for (const ScanLabel& label : labels->labels) {
    result.push_back(label.time.count());
  }
  return result;
}

std::string error_of(const Paths& files) {
  const auto labels = label_scans(files);
  return labels ? "" : labels.error().message;
}

TEST(ScanNames, StampsGiveTheTimeAndTheOrderOfTime) {
  const Paths files{"a/1600000002.050000000.pcd", "a/1600000001.900000001.pcd", "a/1600000003.000000000.pcd"};
  EXPECT_THAT(numbers(files), ElementsAre(1, 0, 2));
  EXPECT_THAT(times_ns(files),
              ElementsAre(1'600'000'002'050'000'000, 1'600'000'001'900'000'001, 1'600'000'003'000'000'000));
  EXPECT_THAT(label_scans(files)->rule,
              AllOf(HasSubstr("time stamp"), HasSubstr("1600000001.900000001 to 1600000003.000000000")));
}

TEST(ScanNames, ReadsTheStampsThatRecordersWrite) {
  EXPECT_THAT(times_ns({"cloud_1600000001_619875000.pcd"}), ElementsAre(1'600'000'001'619'875'000));
  EXPECT_THAT(times_ns({"7-1600000001-619875000-raw.csv"}), ElementsAre(1'600'000'001'619'875'000));
  EXPECT_THAT(times_ns({"1600000001619.pcd"}), ElementsAre(1'600'000'001'619'000'000));
  EXPECT_THAT(times_ns({"1600000001619875.pcd"}), ElementsAre(1'600'000'001'619'875'000));
  EXPECT_THAT(times_ns({"1600000001619875123.pcd"}), ElementsAre(1'600'000'001'619'875'123));
  EXPECT_THAT(times_ns({"left_1600000002.5.pcd", "right_1600000001.25.pcd"}),
              ElementsAre(1'600'000'002'500'000'000, 1'600'000'001'250'000'000))
      << "decimals without trailing zeros";
}

TEST(ScanNames, NanosecondsWithoutLeadingZerosAreDistinguishedFromDecimals) {
  const Paths files{"1600000001.5000000.pcd", "1600000001.120000000.pcd", "1600000001.999999990.pcd"};
  EXPECT_THAT(times_ns(files),
              ElementsAre(1'600'000'001'005'000'000, 1'600'000'001'120'000'000, 1'600'000'001'999'999'990));
  EXPECT_THAT(label_scans(files)->rule, HasSubstr("seconds and whole nanoseconds"));
  EXPECT_THAT(times_ns({"c_1600000001_5000000.pcd", "c_1600000001_120000000.pcd", "c_1600000000_7.pcd"}),
              ElementsAre(1'600'000'001'005'000'000, 1'600'000'001'120'000'000, 1'600'000'000'000'000'007));
  EXPECT_THAT(times_ns({"1600000001.12345678912.pcd"}), ElementsAre(1'600'000'001'123'456'789));
}

TEST(ScanNames, AStampStaysOneWhateverNumbersFollow) {
  EXPECT_THAT(times_ns({"1600000002.100000000_cam3.pcd", "1600000001.900000000_cam3.pcd"}),
              ElementsAre(1'600'000'002'100'000'000, 1'600'000'001'900'000'000));
  EXPECT_THAT(times_ns({"1600000002.100000000_1.pcd", "1600000001.900000000_2_3.pcd"}),
              ElementsAre(1'600'000'002'100'000'000, 1'600'000'001'900'000'000));
}

TEST(ScanNames, AStampMayHaveNoFractionBesideOthersThatHave) {
  EXPECT_THAT(times_ns({"1600000002.pcd", "1600000001.5.pcd", "1600000001.25.pcd"}),
              ElementsAre(1'600'000'002'000'000'000, 1'600'000'001'500'000'000, 1'600'000'001'250'000'000));
  EXPECT_THAT(error_of({"1600000001.5.pcd", "160000002.pcd"}), HasSubstr("160000002.pcd: has no time stamp"));
}

TEST(ScanNames, DatesWithATimeOfDayAreTimes) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr std::int64_t kNoon = 1'718'452'800 * kSecond;  // 2024-06-15T12:00:00Z
  EXPECT_THAT(times_ns({"2024-06-15T12:00:01.250000.pcd", "2024-06-15T12:00:01.pcd"}),
              ElementsAre(kNoon + 1'250'000'000, kNoon + kSecond));
  EXPECT_THAT(
      times_ns({"2024-06-15_12-00-02.pcd", "2024-06-15_12-00-01.5.pcd", "2024-06-15_12-00-01.123.pcd"}),
      ElementsAre(kNoon + 2 * kSecond, kNoon + 1'500'000'000, kNoon + 1'123'000'000));
  EXPECT_THAT(times_ns({"cam1_20240615T120000Z.pcd", "cam1_20240614T120000Z.pcd"}),
              ElementsAre(kNoon, kNoon - 86'400 * kSecond));
  EXPECT_THAT(times_ns({"20240615_120000_500.pcd", "20240615_120000_040.pcd"}),
              ElementsAre(kNoon + 500'000'000, kNoon + 40'000'000));
  EXPECT_THAT(times_ns({"20240615120000007.pcd"}), ElementsAre(kNoon + 7'000'000));
  EXPECT_THAT(numbers({"2024-06-15T12:00:00.pcd", "2024-06-14T23:00:00.pcd"}), ElementsAre(1, 0));
  EXPECT_THAT(label_scans(Paths{"20240615T120000.pcd"})->rule, HasSubstr("UTC"));
}

TEST(ScanNames, OneDateInAllNamesIsThatOfTheRun) {
  EXPECT_THAT(numbers({"2024-06-15_12-00-02_f7.pcd", "2024-06-15_12-00-02_f4.pcd"}), ElementsAre(7, 4));
  EXPECT_THAT(numbers({"15-06-2024_f7.pcd", "15-06-2024_f4.pcd"}), ElementsAre(7, 4));
  EXPECT_THAT(numbers({"2024-13-15_12-00-02.pcd", "2024-13-15_12-00-01.pcd"}), ElementsAre(2, 1))
      << "no month, so no date";
}

TEST(ScanNames, RefusesDifferentDatesWithTheYearLast) {
  EXPECT_THAT(
      error_of({"03-02-2024_10-00-00.pcd", "04-01-2024_10-00-00.pcd"}),
      AllOf(HasSubstr("04-01-2024_10-00-00.pcd: has the date 04-01-2024"), HasSubstr("YEAR-MONTH-DAY")));
}

TEST(ScanNames, SecondsOfASimulationAreTimes) {
  EXPECT_THAT(times_ns({"12.500000000.pcd", "9.100000000.pcd"}), ElementsAre(12'500'000'000, 9'100'000'000));
  EXPECT_THAT(times_ns({"12.500000.pcd", "13.100000.pcd"}), ElementsAre(12'500'000'000, 13'100'000'000));
  EXPECT_THAT(times_ns({"12.5.pcd", "13.0.pcd", "9.1.pcd"}),
              ElementsAre(12'500'000'000, 13'000'000'000, 9'100'000'000));
  EXPECT_THAT(numbers({"t0.5.pcd", "t0.55.pcd", "t0.6.pcd"}), ElementsAre(0, 1, 2));
  EXPECT_THAT(numbers({"plot1.9.pcd", "plot1.10.pcd", "plot1.11.pcd"}), ElementsAre(9, 10, 11))
      << "a counter";
}

TEST(ScanNames, ANumberBehindSecondsIsNoFractionByItself) {
  EXPECT_THAT(numbers({"1600000002_12.pcd", "1600000001_13.pcd"}), ElementsAre(1600000002, 1600000001));
  EXPECT_THAT(numbers({"1600000001_2.pcd", "1600000001_10.pcd"}), ElementsAre(2, 10));
}

TEST(ScanNames, TheNumberIsTheOneThatDiffers) {
  EXPECT_THAT(numbers({"frame_000012_os1.pcd", "frame_000003_os1.pcd"}), ElementsAre(12, 3));
  EXPECT_THAT(numbers({"os2_9.pcd", "os2_10.pcd", "os2_011.pcd"}), ElementsAre(9, 10, 11));
  EXPECT_THAT(times_ns({"s_2_x3.csv", "s_1_x3.csv"}), ElementsAre(2'000'000'000, 1'000'000'000));
  EXPECT_THAT(label_scans(Paths{"f_1_os1.pcd", "f_2_os1.pcd"})->rule, HasSubstr("by the number"));
}

TEST(ScanNames, OfSeveralNumbersTheLeftmostComesFirst) {
  EXPECT_THAT(numbers({"frame_12_os2.pcd", "frame_9_os7.pcd"}), ElementsAre(12, 9));
  EXPECT_THAT(numbers({"run2_scan1.pcd", "run1_scan10.pcd", "run1_scan9.pcd"}), ElementsAre(2, 1, 0));
  EXPECT_THAT(label_scans(Paths{"r2_1.pcd", "r1_1.pcd", "r1_2.pcd"})->rule, HasSubstr("all numbers"));
  EXPECT_THAT(numbers({"a/r2_1.pcd", "b/r2_1.pcd", "a/r1_2.pcd"}), ElementsAre(1, 2, 0));
}

TEST(ScanNames, DifferentWordsLeaveTheLastNumber) {
  EXPECT_THAT(numbers({"s_10.pcd", "t_002.csv", "a1b22c.pcd"}), ElementsAre(10, 2, 22));
}

// A stray name, two sensors in one folder, the same names in two folders, numbers beyond all scans: nothing
// good is refused for it.
TEST(ScanNames, WhereNoNumberTellsTheScansApartTheirNamesDo) {
  EXPECT_THAT(numbers({"s_2.pcd", "s_10.pcd", "all_2.pcd"}), ElementsAre(1, 2, 0));
  EXPECT_THAT(numbers({"b_07.pcd", "a_7.pcd"}), ElementsAre(1, 0));
  EXPECT_THAT(numbers({"12/cloud.pcd", "s_1.pcd"}), ElementsAre(0, 1));
  EXPECT_THAT(numbers({"run2/1.csv", "run10/1.csv", "run2/2.csv"}), ElementsAre(0, 2, 1));
  EXPECT_THAT(numbers({"s_7.pcd", "s_07.pcd"}), ElementsAre(1, 0));
  EXPECT_THAT(numbers({"s_99999999999999999998.pcd", "s_9000000001.pcd", "s_100000000000000000000.pcd"}),
              ElementsAre(1, 0, 2));
  EXPECT_THAT(label_scans(Paths{"cloud.pcd", "s_1.pcd"})->rule, HasSubstr("by name"));
  EXPECT_THAT(
      error_of({"a/s_1.pcd", "a/s_1.csv"}),
      AllOf(HasSubstr("a/s_1.pcd"), HasSubstr("a/s_1.csv: has the same name"), HasSubstr("rename one")));
  EXPECT_THAT(error_of({"a/cloud.pcd", "a/../a/cloud.pcd"}), HasSubstr("has the same name"));
}

TEST(ScanNames, AloneAFileNeedsNoNumber) {
  EXPECT_THAT(numbers({"cloud.pcd"}), ElementsAre(0));
  EXPECT_THAT(numbers({"frame_000012_os1.pcd"}), ElementsAre(12));
  EXPECT_THAT(numbers({"site2/scan_0012.pcd"}), ElementsAre(12));
  for (const char* name : {"s_9000000001.pcd", "99999999999999999999.pcd", "9999999999.999999999.pcd"}) {
    EXPECT_THAT(error_of({name}), HasSubstr("too large")) << name;
  }
  EXPECT_TRUE(label_scans({})->labels.empty());
}

TEST(ScanNames, RefusesStampsThatOnlySomeNamesHave) {
  EXPECT_THAT(error_of({"1600000001.5.pcd", "scan_3.pcd"}), HasSubstr("scan_3.pcd: has no time stamp"));
  EXPECT_THAT(error_of({"a_1600000001.50.pcd", "b_1600000001.500.pcd"}),
              AllOf(HasSubstr("the time stamp 1600000001.500000000"), HasSubstr("rename one")));
}

}  // namespace
}  // namespace slamsensor::tools
