#include "tests/unit/firmware/lcm/sample_reports.hpp"
#include "tools/top/top_frame.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace slamsensor::tools {
namespace {

using std::chrono::seconds;

/// A view with the means to send to it.
struct Bench {
  SensorView view{"SLAMSENSOR_"};
  std::array<std::uint8_t, 1400> out{};

  void send(std::size_t size, hal::Stamp now, std::string_view channel = "SLAMSENSOR_ANY") {
    view.on_message({channel, {out.data(), size}}, now);
  }
  void send_map(const firmware::LcmMapView& map) {
    for (std::uint32_t chunk = 0; chunk < firmware::map_chunks(map); ++chunk) {
      send(firmware::encode_map_chunk(map, chunk, out), seconds(1));
    }
  }
  [[nodiscard]] std::size_t landmarks() const {
    std::size_t sum = 0;
    for (const auto& [number, chunk] : view.map()) {
      sum += chunk.size();
    }
    return sum;
  }
};

TEST(SensorView, HearsItsOwnChannelsAlone) {
  Bench bench;
  const std::size_t size = firmware::encode_pose(tests::sample_report(), bench.out);
  bench.send(size, seconds(1), "OTHER_POSE");
  EXPECT_FALSE(bench.view.heard());
  bench.send(size - 1, seconds(1));
  EXPECT_FALSE(bench.view.heard());
  bench.send(size, seconds(2));
  EXPECT_EQ(bench.view.heard(), seconds(2));
  ASSERT_TRUE(bench.view.pose());
  EXPECT_EQ(bench.view.path_W().size(), 1U);
}

TEST(SensorView, KeepsFixesAsItsPathWithinBounds) {
  Bench bench;
  firmware::FixReport report = tests::sample_report();
  for (std::size_t i = 0; i < SensorView::kPathMax + 5; ++i) {
    report.fix.pose_W.x_m = static_cast<double>(i);
    bench.send(firmware::encode_pose(report, bench.out), seconds(1));
  }
  EXPECT_EQ(bench.view.path_W().size(), SensorView::kPathMax);
  EXPECT_EQ(bench.view.path_W().front().x_m, 5.0);
  report.fix.status = core::FixStatus::Ambiguous;
  report.fix.pose_W.x_m = -1.0;
  bench.send(firmware::encode_pose(report, bench.out), seconds(1));
  report.fix.status = core::FixStatus::Fix;
  report.fix.pose_W.x_m = std::numeric_limits<double>::quiet_NaN();
  bench.send(firmware::encode_pose(report, bench.out), seconds(1));
  EXPECT_EQ(bench.view.path_W().back().x_m, static_cast<double>(SensorView::kPathMax + 4));
}

TEST(SensorView, PutsMapAndCountersTogether) {
  Bench bench;
  firmware::SensorStatus status = tests::sample_status();
  status.report.initialization = 99;
  for (std::size_t part = 0; part < 2; ++part) {
    bench.send(firmware::encode_counters(status, {}, firmware::LcmStation::Head, part, bench.out),
               seconds(1));
  }
  const auto& counters = bench.view.counters(firmware::LcmStation::Head);
  ASSERT_EQ(counters.size(), 30U);
  EXPECT_EQ(counters[29].name, "resynchronised");
  EXPECT_EQ(counters[29].changed, hal::Stamp::min());
  status.head.counters.counters[29].value += 1;
  bench.send(firmware::encode_counters(status, {}, firmware::LcmStation::Head, 1, bench.out), seconds(2));
  EXPECT_EQ(bench.view.counters(firmware::LcmStation::Head)[29].changed, seconds(2));

  bench.send_map(tests::SampleMap(100).view());
  EXPECT_EQ(bench.landmarks(), 100U);
  bench.send_map(tests::SampleMap(40).view());
  EXPECT_EQ(bench.landmarks(), 40U) << "a smaller map must leave nothing of the larger one";
}

TEST(SensorView, BeginsAnewWithTheSensor) {
  Bench bench;
  bench.send_map(tests::SampleMap(10).view());  // of the start 99
  EXPECT_EQ(bench.landmarks(), 10U);
  bench.send(firmware::encode_pose(tests::sample_report(), bench.out), seconds(3));
  EXPECT_EQ(bench.landmarks(), 0U);
  EXPECT_TRUE(bench.view.pose());
  EXPECT_FALSE(bench.view.status());
}

}  // namespace
}  // namespace slamsensor::tools
