#include "tests/unit/tools/emulator/small_devices.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/memory_can_bus.hpp"
#include "tools/emulator/real_time_head.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <unistd.h>

namespace slamsensor::tools {
namespace {

TEST(Lateness, KeepsTheWorstAndAHistogram) {
  Lateness late;
  EXPECT_EQ(late.text(), "nothing was sent");
  EXPECT_EQ(late.within(0.5), 0ns);
  late.count(50us, 98);
  late.count(700us);
  late.count(30ms);
  EXPECT_EQ(late.worst(), 30ms);
  EXPECT_EQ(late.total(), 100U);
  EXPECT_EQ(late.within(0.98), 100us);
  EXPECT_EQ(late.within(0.99), 1ms);
  EXPECT_EQ(late.within(1.0), 50ms);
  EXPECT_EQ(late.text(), "worst 30.00 ms; up to 0.1 ms: 98 up to 1 ms: 1 up to 50 ms: 1");
  late.count(2s);
  EXPECT_EQ(late.within(1.0), hal::kNever);
}

Scenario open_field() {
  Scenario scenario;
  scenario.world.stands = {{{0.0, 0.0, 0.0}}, {{5.0, 1.0, 0.5}}};
  scenario.drive.period_s = 0.05;
  scenario.kidnaps = {{0.02, {1.0, 2.0, 0.0}}};
  scenario.faults = {{"rangefinder", FaultKind::Stall, 0.03, 0.25}};
  return scenario;
}

TEST(HeadTruth, PlacesAndEventsOnTheClock) {
  const auto head = EmulatedHead::create(open_field(), make_small_devices);
  ASSERT_TRUE(head.has_value());
  (*head)->advance(1s);
  EXPECT_EQ(format_visits(**head, 100s),
            "100 0.000000 0.000000 0.000000 0.000000000 0.000000000 0.000000000 1.000000000\n"
            "100.02 1.000000 2.000000 0.000000 0.000000000 0.000000000 0.000000000 1.000000000\n"
            "100.05 5.000000 1.000000 0.000000 0.000000000 0.000000000 0.247403959 0.968912422\n");
  EXPECT_EQ(format_events(**head, 100s),
            "t_s,event,device,fault,duration_s,known\n"
            "100.000000,stand,,,,1\n"
            "100.020000,kidnap,,,,1\n"
            "100.030000,fault,rangefinder,stall,0.25,1\n"
            "100.050000,stand,,,,1\n");
  EXPECT_EQ(events_path("a/run.tum"), "a/run.events.csv");
}

class RealTimeHeadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    config_.ptu = folder_ / "ptu0";
    config_.rangefinder = folder_ / "rangefinder0";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("real_time_test_" + std::to_string(::getpid()));
  RealTimeConfig config_;
};

TEST_F(RealTimeHeadTest, RunsToItsEndAndLeavesNoNames) {
  const auto head = EmulatedHead::create(open_field(), make_small_devices);
  ASSERT_TRUE(head.has_value());
  {
    const auto real_time = RealTimeHead::create(**head, config_);
    ASSERT_TRUE(real_time.has_value()) << real_time.error().message;
    EXPECT_TRUE(std::filesystem::is_symlink(config_.ptu));
    EXPECT_TRUE(std::filesystem::is_symlink(config_.rangefinder));
    RealTimeHead::Orders orders;
    (*real_time)->run(100ms, orders);
    EXPECT_EQ((*head)->clock().now, 100ms);
    EXPECT_EQ((*head)->visits().size(), 3U);
    orders.stop = 1;
    (*real_time)->run(hal::kNever, orders);
    EXPECT_EQ((*head)->clock().now, 100ms);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(RealTimeHeadTest, APlaceThatCannotBeHadLeavesNothingBehind) {
  const auto head = EmulatedHead::create(open_field(), make_small_devices);
  ASSERT_TRUE(head.has_value());
  config_.rangefinder = folder_ / "missing" / "rangefinder0";
  EXPECT_FALSE(RealTimeHead::create(**head, config_).has_value());
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

/// Sends a frame when told and keeps what it hears.
class Node final : public EmulatedCanDevice {
 public:
  void advance(Stamp) override {}
  [[nodiscard]] Stamp next_event() const override { return hal::kNever; }
  bool inject(const Fault&) override { return false; }
  void receive(const hal::CanFrame& frame, Stamp) override { heard.push_back(frame.id); }

  std::vector<std::uint32_t> heard;
};

TEST(CanPort, JoinsTheDevicesBusWithAnInterface) {
  MemoryCanBus devices;
  FrameSink& sink = devices.add_device_node();
  Node device;
  devices.attach(sink, device);
  MemoryCanBus interface;  // stands for the real one
  FrameSink& other_sink = interface.add_device_node();
  Node other;
  interface.attach(other_sink, other);
  SimClock clock;
  MemoryCanLink link(interface, clock);
  CanPort port(devices, link);
  Lateness late;
  const auto go = [&](Stamp now) {
    devices.advance(now);
    interface.advance(now);
    clock.now = now;
    port.exchange(now, now, late);
  };
  go(0ms);
  hal::CanFrame frame;
  frame.id = 0x181;
  sink.send(frame, 0ms);
  frame.id = 0x601;
  other_sink.send(frame, 0ms);
  go(1ms);
  go(2ms);
  EXPECT_EQ(other.heard, (std::vector<std::uint32_t>{0x181}));
  EXPECT_EQ(device.heard, (std::vector<std::uint32_t>{0x601}));
  EXPECT_EQ(late.total(), 1U);
  ASSERT_TRUE(devices.inject({FaultKind::BusOff, 2ms, 10ms}));
  sink.send(frame, 3ms);
  other_sink.send(frame, 3ms);
  go(4ms);
  go(20ms);
  EXPECT_EQ(other.heard.size(), 1U);
  EXPECT_EQ(device.heard.size(), 1U);
  EXPECT_EQ(port.lost_frames(), 1U);
}

}  // namespace
}  // namespace slamsensor::tools
