#include "firmware/daemon/inclination_loop.hpp"

#include "core/config.hpp"
#include "firmware/scan/scan_scheduler.hpp"
#include "tests/support/fake_iio.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kMaxAge = std::chrono::seconds(3);

InclinationReport report_at(hal::Stamp stamp, double roll_rad) {
  InclinationReport report;
  report.device.state = hal::DeviceState::Ready;
  report.latest = hal::Inclination{stamp, roll_rad, 0.0};
  return report;
}

class Feed : public testing::Test {
 protected:
  void post(const InclinationReport& report) {
    reports.draft() = report;
    reports.post();
  }

  Mailbox<InclinationReport> reports;
  InclinationFeed feed{reports, kMaxAge};
  hal::Stamp now = std::chrono::seconds(100);
};

TEST_F(Feed, ReportsEachMeasurementOnce) {
  EXPECT_FALSE(feed.step(now));
  post(report_at(now, 0.25));
  const auto order = feed.step(now);
  ASSERT_TRUE(order);
  EXPECT_EQ(order->what, TapeCommand::Incline);
  EXPECT_EQ(order->argument, pack_inclination(0.25, 0.0));
  EXPECT_FALSE(feed.step(now));
  post(report_at(now, 0.25));
  EXPECT_FALSE(feed.step(now)) << "a report without a new measurement";
  post(report_at(now + std::chrono::milliseconds(100), 0.5));
  EXPECT_TRUE(feed.step(now + std::chrono::milliseconds(100)));
}

TEST_F(Feed, HoldsTheHeadOnceWhenMeasurementsStayAway) {
  post(report_at(now, 0.0));
  ASSERT_TRUE(feed.step(now));
  EXPECT_FALSE(feed.step(now + kMaxAge));
  const auto order = feed.step(now + kMaxAge + hal::Stamp{1});
  ASSERT_TRUE(order);
  EXPECT_EQ(order->what, TapeCommand::Hold);
  EXPECT_EQ(order->argument, static_cast<std::uint64_t>(HoldReason::LeanUnknown));
  EXPECT_FALSE(feed.step(now + 2 * kMaxAge));
  post(report_at(now + 2 * kMaxAge, 0.0));
  EXPECT_EQ(feed.step(now + 2 * kMaxAge)->what, TapeCommand::Incline);
}

TEST_F(Feed, AMeasurementThatIsTooOldIsNone) {
  post(report_at(now - 2 * kMaxAge, 0.0));
  EXPECT_FALSE(feed.step(now));
}

TEST_F(Feed, ADeviceThatFellSilentIsNotRefreshedByItsReports) {
  post(report_at(now, 0.0));
  ASSERT_TRUE(feed.step(now));
  InclinationReport lost = report_at(now, 0.0);
  lost.device.state = hal::DeviceState::Faulted;
  hal::Stamp later = now;
  std::optional<InclinationFeed::Order> order;
  for (; !order && later < now + 2 * kMaxAge; later += std::chrono::milliseconds(100)) {
    post(lost);
    order = feed.step(later);
  }
  ASSERT_TRUE(order);
  EXPECT_EQ(order->what, TapeCommand::Hold);
  EXPECT_EQ(feed.device().state, hal::DeviceState::Faulted);
}

TEST(InclinationLoop, IsNoneWithoutAnInclinometer) {
  Config config;
  EXPECT_EQ(*InclinationLoop::create(config), nullptr);
  config.scan_head.levelling.source = InclinationSource::Fixed;
  EXPECT_EQ(*InclinationLoop::create(config), nullptr);
}

TEST(InclinationLoop, PostsStateAndMeasurements) {
  const tests::FakeIio iio;
  iio.set_raw(0, 22, 255);
  Config config;
  config.scan_head.levelling.source = InclinationSource::Iio;
  config.head.iio.device = iio.folder().string();
  auto loop = InclinationLoop::create(config);
  ASSERT_TRUE(loop) << loop.error();
  Mailbox<InclinationReport>& reports = (*loop)->reports();
  hal::Stamp now = std::chrono::seconds(5);
  for (int i = 0; i < 200; ++i) {
    now += std::chrono::milliseconds(5);
    (*loop)->step(now);
  }
  ASSERT_TRUE(reports.refresh());
  EXPECT_EQ(reports.value().device.state, hal::DeviceState::Ready);
  EXPECT_EQ(reports.value().device.model.view(), "adxl345");
  ASSERT_TRUE(reports.value().latest);
  EXPECT_NEAR(reports.value().latest->roll_rad, 4.93 * core::kDegree, 1e-3);
  iio.set_raw(0, 0, 300);
  for (int i = 0; i < 200; ++i) {
    now += std::chrono::milliseconds(5);
    (*loop)->step(now);
  }
  ASSERT_TRUE(reports.refresh());
  EXPECT_EQ(reports.value().device.state, hal::DeviceState::Faulted);
  EXPECT_FALSE(reports.value().device.problem.view().empty());
}

TEST(InclinationLoop, CanIsOpenedAndMayBeAbsent) {
  Config config;
  config.scan_head.levelling.source = InclinationSource::Can;
  config.head.cia410.interface = "nocan7";
  auto loop = InclinationLoop::create(config);
  ASSERT_TRUE(loop) << loop.error();
  (*loop)->step(std::chrono::seconds(1));
  ASSERT_TRUE((*loop)->reports().refresh());
  EXPECT_EQ((*loop)->reports().value().device.state, hal::DeviceState::Absent);
  EXPECT_NE((*loop)->reports().value().device.problem.view().find("nocan7"), std::string_view::npos);
}

}  // namespace
}  // namespace slamsensor::firmware
