#include "core/detection/scanline.hpp"

#include "tests/unit/core/detection/detection_support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace slamsensor::core {
namespace {

using detection_test::hand_config;
using detection_test::middle_rad;
using detection_test::Scanline;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

constexpr double kNone = Reading::kNoReturn;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Line : public tests::InArena<ScanlineGrid> {
 public:
  explicit Line(const DetectionConfig& config) : InArena(config) {}

  /// (row, column) of every sighting, by column.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cells(const Scanline& scanline) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> cells;
    for (const Sighting& sighting : (*this)->sightings(scanline)) {
      cells.emplace_back(sighting.row, sighting.column);
    }
    std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    return cells;
  }
};

/// A reading in the middle of a column of hand_config().
Reading at(std::uint32_t column, double range_m, double tilt_rad = 0.0) {
  return {middle_rad(hand_config(), column), tilt_rad, range_m};
}

/// No return in all 20 columns.
Scanline open_sky() {
  Scanline scanline;
  for (std::uint32_t column = 0; column < 20; ++column) {
    scanline.push_back(at(column, kNone));
  }
  return scanline;
}

Scanline with(Scanline scanline, const Scanline& more) {
  scanline.insert(scanline.end(), more.begin(), more.end());
  return scanline;
}

// The row of clusters_test's HandWorkedScanline, as readings that the folding has to make it from.
TEST(Scanline, HandWorkedFromReadings) {
  const Scanline readings{
      at(0, 10.9),  at(0, 55.0),
      at(1, kNone), at(1, 11.0),  // the nearest counts; a distance beats no return
      at(2, 30.5),  at(3, 31.999),
      at(4, kNone), at(5, 20.0),  //
      at(6, 21.5),  at(7, 20.1),
      at(7, 21.0),  at(8, 100.5),  // beyond range_max: no return
      at(9, 40.5),  at(10, 15.5),
      at(11, 25.5), at(12, 18.5),  // nothing looks into column 13
      at(14, 5.5),  at(15, 50.5),
      at(16, 22.5), at(17, kNone),  //
      at(18, 12.5), at(19, 11.5),
  };
  Line line(hand_config());
  EXPECT_THAT(line.cells(readings),
              ElementsAre(Pair(10, 0), Pair(11, 1), Pair(20, 5), Pair(21, 6), Pair(20, 7), Pair(15, 10),
                          Pair(22, 16), Pair(12, 18), Pair(11, 19)));
  EXPECT_THAT(line->row(), ElementsAre(10, 11, 30, 31, kInfiniteColumn, 20, 21, 20, kInfiniteColumn, 40, 15,
                                       25, 18, kEmptyColumn, 5, 50, 22, kInfiniteColumn, 12, 11));
}

TEST(Scanline, CarrierReturnsLeaveTheColumnAsItWas) {
  DetectionConfig config = hand_config();
  config.range_min_m = 2.0;
  Line line(config);
  const Scanline scanline{at(0, 1.99),               // the carrier only: empty
                          at(1, 1.0),   at(1, 8.0),  // the carrier and a distance
                          at(2, kNone), at(2, 0.0),  // no return and the carrier
                          at(3, 2.0)};               // exactly range_min is a distance
  EXPECT_THAT(line.cells(scanline), ElementsAre());  // 8 adjoins an empty column, 2 adjoins one too
  EXPECT_EQ(line->row()[0], kEmptyColumn);
  EXPECT_EQ(line->row()[1], 8);
  EXPECT_EQ(line->row()[2], kInfiniteColumn);
  EXPECT_EQ(line->row()[3], 2);
  EXPECT_EQ(line->readings_refused(), 0U);
}

TEST(Scanline, GreatestRangeIsInTheOutermostRow) {
  Line line(hand_config());
  EXPECT_THAT(line.cells(with(open_sky(), {at(4, 100.0), at(8, std::nextafter(100.0, 101.0))})),
              ElementsAre(Pair(99, 4)));
}

TEST(Scanline, DistanceIsHorizontal) {
  Line line(hand_config());
  EXPECT_THAT(line.cells(with(open_sky(), {at(4, 20.5, 60.0 * kDegree), at(9, 20.5, -60.0 * kDegree),
                                           at(14, 20.5, 30.0 * kDegree), at(17, 20.5, 90.0 * kDegree)})),
              ElementsAre(Pair(10, 4), Pair(10, 9), Pair(17, 14), Pair(0, 17)));
}

TEST(Scanline, EndsAreDiscardedByShare) {
  DetectionConfig config = hand_config();
  const auto empty_columns = [&](double share) {
    config.discard_share = share;
    Line line(config);
    std::vector<std::uint32_t> empty;
    EXPECT_THAT(line.cells(open_sky()), IsEmpty());
    for (std::uint32_t column = 0; column < 20; ++column) {
      if (line->row()[column] == kEmptyColumn) {
        empty.push_back(column);
      }
    }
    return empty;
  };
  EXPECT_THAT(empty_columns(0.0), IsEmpty());
  EXPECT_THAT(empty_columns(0.049), IsEmpty());  // floor(0.98)
  EXPECT_THAT(empty_columns(0.05), ElementsAre(0, 19));
  EXPECT_THAT(empty_columns(0.149), ElementsAre(0, 1, 18, 19));
  EXPECT_THAT(empty_columns(0.15), ElementsAre(0, 1, 2, 17, 18, 19));
  EXPECT_EQ(empty_columns(0.45).size(), 18U);
}

TEST(Scanline, DiscardingHalfAtEachEndLeavesNothing) {
  DetectionConfig config = hand_config();
  const Scanline tree = with(open_sky(), {at(9, 5.0)});
  for (const double share : {0.5, 0.7, 1e300}) {
    config.discard_share = share;
    Line line(config);
    EXPECT_THAT(line.cells(tree), IsEmpty()) << share;
  }
}

TEST(Scanline, WholeSharesAreNotRoundedDown) {
  DetectionConfig config = hand_config();
  config.discard_share = 0.29;  // 0.29 * 100 is 28.999999999999996
  Line line(config);
  Scanline scanline(100, at(0, kNone));
  scanline[28] = at(1, kNone);
  scanline[71] = at(2, kNone);
  EXPECT_THAT(line.cells(scanline), IsEmpty());
  EXPECT_EQ(line->row()[1], kEmptyColumn);
  EXPECT_EQ(line->row()[2], kEmptyColumn);
}

TEST(Scanline, TiltOutsideItsBoundsLeavesTheScanlineOut) {
  DetectionConfig config = hand_config();
  config.tilt_min_rad = -0.3;
  config.tilt_max_rad = 0.2;
  Line line(config);
  const auto seen = [&](double tilt_rad) {
    Scanline scanline;
    for (std::uint32_t column = 0; column < 20; ++column) {
      scanline.push_back(at(column, column == 7 ? 5.0 : kNone, tilt_rad));
    }
    return !line->sightings(scanline).empty();
  };
  EXPECT_TRUE(seen(-0.3));  // the bounds are inside
  EXPECT_TRUE(seen(0.2));
  EXPECT_TRUE(seen(0.0));
  EXPECT_FALSE(seen(-0.3001));
  EXPECT_FALSE(seen(0.2001));
  EXPECT_FALSE(seen(kNan));
  EXPECT_TRUE(seen(0.1));  // nothing stays of the ones left out
}

TEST(Scanline, TiltOfALevelledRingIsItsMean) {
  DetectionConfig config = hand_config();
  config.tilt_max_rad = 0.1;
  Line line(config);
  const auto ring = [](double tilt_rad) {
    Scanline scanline;
    for (std::uint32_t column = 0; column < 20; ++column) {
      const double wobble_rad = 0.05 * std::cos(middle_rad(hand_config(), column));
      scanline.push_back(at(column, column == 7 ? 5.0 : kNone, tilt_rad + wobble_rad));
    }
    return scanline;
  };
  EXPECT_FALSE(line->sightings(ring(0.08)).empty());  // up to 0.13 rad in places
  EXPECT_TRUE(line->sightings(ring(0.12)).empty());   // down to 0.07 rad in places
}

TEST(Scanline, ImpossibleReadingsAreCountedAndChangeNothing) {
  Line line(hand_config());
  const Scanline good = with(open_sky(), {at(5, 20.0), at(6, 21.0)});
  const auto expected = line.cells(good);
  Scanline bad = good;
  for (const double value : {kNan, kInfinity, -kInfinity}) {
    bad.push_back({value, 0.0, 1.0});
    bad.push_back({middle_rad(hand_config(), 5), value, 1.0});
    bad.push_back(at(5, value));
  }
  for (const double range_m : {-0.5, -1.0000001, -2.0, -1e300}) {
    bad.push_back(at(5, range_m));
  }
  for (const double tilt_rad : {1.6, -1.6, 3.2, 1e300}) {
    bad.push_back(at(5, 1.0, tilt_rad));
  }
  EXPECT_EQ(line.cells(bad), expected);
  EXPECT_EQ(line->readings_refused(), bad.size() - good.size());
}

TEST(Scanline, HugeFiniteValuesAreTakenAsTheyAre) {
  Line line(hand_config());
  EXPECT_THAT(line.cells({at(3, 1e300), {1e300, 0.0, 5.0}, {-1e15, 0.0, 5.0}}),
              testing::SizeIs(testing::Le(2U)));
  EXPECT_EQ(line->row()[3], kInfiniteColumn);
  EXPECT_EQ(line->readings_refused(), 0U);
}

TEST(Scanline, NothingComesOfNothing) {
  Line line(hand_config());
  EXPECT_THAT(line.cells({}), IsEmpty());
  EXPECT_THAT(line.cells(Scanline(50, {kNan, kNan, kNan})), IsEmpty());
}

TEST(Scanline, SightingCarriesTheNearestReading) {
  Line line(hand_config());
  const double step_rad = hand_config().bearing_step_rad;
  const Reading near{5.2 * step_rad, 0.0, 20.25};
  const Scanline scanline =
      with(open_sky(), {{5.5 * step_rad, 0.0, 20.75}, near, {5.7 * step_rad, 0.0, 20.5}});
  const auto sightings = line->sightings(scanline);
  ASSERT_EQ(sightings.size(), 1U);
  EXPECT_EQ(sightings[0].horizontal_m, near.range_m);
  EXPECT_EQ(sightings[0].bearing_rad, near.pan_rad);
}

TEST(Scanline, OfEquallyNearReadingsTheOneInTheMiddleCounts) {
  Line line(hand_config());
  const double step_rad = hand_config().bearing_step_rad;
  Scanline ties{{5.2 * step_rad, 0.0, 20.0}, {5.45 * step_rad, 0.0, 20.0}, {5.9 * step_rad, 0.0, 20.0}};
  do {
    const auto sightings = line->sightings(with(open_sky(), ties));
    ASSERT_EQ(sightings.size(), 1U);
    EXPECT_EQ(sightings[0].bearing_rad, 5.45 * step_rad);
  } while (std::next_permutation(ties.begin(), ties.end(),
                                 [](const Reading& a, const Reading& b) { return a.pan_rad < b.pan_rad; }));
}

}  // namespace
}  // namespace slamsensor::core
