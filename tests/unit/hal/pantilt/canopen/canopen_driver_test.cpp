#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"
#include "hal/pantilt/canopen/cia402.hpp"
#include "tests/support/no_alloc_scope.hpp"
#include "tests/support/scripted_can_link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::tests {
namespace {

/// A drive as a test plays it: an object dictionary of fixed size and just enough behaviour. Every frame it
/// sends is written out here, by hand.
struct PlayedNode {
  explicit PlayedNode(int number) : node(number) {
    objects = {{0x100000, 0x00020192},
               {0x100100, 0},
               {0x101801, 7},
               {0x101802, 9},
               {0x650200, 0x25},
               {0x607D01, -200000},
               {0x607D02, 200000},
               {0x607F00, 50000},
               {0x608100, 1000},
               {0x608300, 100000},
               {0x140001, 0x200 + node},
               {0x180001, 0x40000180 + node},
               {0x606400, 0},
               {0x606100, 1},
               {0x604100, 0x0240}};
  }

  void on_sdo(const hal::CanFrame& f, ScriptedCanLink& link) {
    const int key = f.data[2] << 16 | f.data[1] << 8 | f.data[3];
    const int at = key == refused ? 0x80 : f.data[0];
    if (at == 0x80) {
      link.deliver(can_frame(id(0x580), {0x80, f.data[1], f.data[2], f.data[3], 0, 0, 2, 6}));
    } else if (at == 0x40) {
      const bool known = objects.contains(key);
      const auto value = static_cast<std::uint32_t>(known ? objects[key] : 0x06020000);
      hal::CanFrame reply =
          can_frame(id(0x580), {known ? 0x43 : 0x80, f.data[1], f.data[2], f.data[3], 0, 0, 0, 0});
      for (std::size_t i = 0; i < 4; ++i) {
        reply.data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
      }
      link.deliver(reply);
    } else {
      writes.push_back(f);
      const auto value = static_cast<int>(hal::le_number(f, 4, 4));
      objects[key] = value;
      if (key == 0x604000) {
        control(value);
      }
      objects[0x606100] = key == 0x606000 ? value : objects[0x606100];
      link.deliver(can_frame(id(0x580), {0x60, f.data[1], f.data[2], f.data[3], 0, 0, 0, 0}));
    }
  }

  void control(int word) {
    const int old = objects[0x604100];
    switch (word & 0x8F) {
      case 0x06:
        objects[0x604100] = 0x0221;
        break;
      case 0x07:
        objects[0x604100] = 0x0223;
        break;
      case 0x0F:
        objects[0x604100] = 0x0627 | ((word & 0x10) << 8);
        break;
      case 0x80:
        objects[0x604100] = 0x0240;
        break;
      default:
        objects[0x604100] = old;
        break;
    }
  }

  [[nodiscard]] std::uint32_t id(int base) const { return static_cast<std::uint32_t>(base + node); }

  int node;
  int refused = -1;  // key of an object
  bool silent = false;
  std::map<int, int> objects;
  std::vector<hal::CanFrame> writes;
};

struct CanopenBench {
  explicit CanopenBench(const hal::CanopenConfig& settings = defaults())
      : driver(std::move(hal::CanopenPanTilt::create(settings, link).value())) {}

  static hal::CanopenConfig defaults() {
    hal::CanopenConfig config;
    config.homing = hal::CanopenHoming::Never;
    return config;
  }

  /// Milliseconds of both nodes and the driver.
  void run(int count) {
    for (int i = 0; i < count; ++i) {
      now += std::chrono::milliseconds(1);
      link.set_now(now);
      driver->step(now);
      for (const hal::CanFrame& frame : link.take_sent()) {
        sent.push_back(frame);
        play(pan, frame);
        play(tilt, frame);
      }
      if (now.count() % 100'000'000 == 0) {
        beat(pan);
        beat(tilt);
      }
    }
  }

  void beat(const PlayedNode& node) {
    if (!node.silent) {
      link.deliver(can_frame(node.id(0x700), {0x05}));
    }
  }

  void play(PlayedNode& node, const hal::CanFrame& frame) {
    if (node.silent) {
      return;
    }
    if (frame.id == node.id(0x600)) {
      node.on_sdo(frame, link);
    } else if (frame.id == 0x080) {
      const int s = node.objects[0x604100];
      const int p = node.objects[0x606400];
      link.deliver(can_frame(node.id(0x180),
                             {s & 255, s >> 8 & 255, p & 255, p >> 8 & 255, p >> 16 & 255, p >> 24 & 255}));
    } else if (frame.id == node.id(0x200)) {
      node.control(frame.data[0] | frame.data[1] << 8);
    }
  }

  [[nodiscard]] std::uint64_t counter(std::string_view name) const {
    const auto all = driver->counters();
    return std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.name == name; })->value;
  }
  [[nodiscard]] std::vector<hal::CanFrame> of(std::uint32_t id) const {
    std::vector<hal::CanFrame> some;
    std::copy_if(sent.begin(), sent.end(), std::back_inserter(some),
                 [&](const auto& f) { return f.id == id; });
    return some;
  }

  ScriptedCanLink link;
  PlayedNode pan{1};
  PlayedNode tilt{2};
  std::unique_ptr<hal::CanopenPanTilt> driver;
  hal::Stamp now = std::chrono::seconds(1);
  std::vector<hal::CanFrame> sent;
};

using hal::Axis;
using hal::DeviceState;
using hal::MoveStatus;

TEST(Canopen, ReadsTheStatesOfADrive) {
  EXPECT_EQ(hal::drive_state(0x0637), hal::DriveState::OperationEnabled);
  EXPECT_EQ(hal::drive_state(0x0240), hal::DriveState::SwitchOnDisabled);
  EXPECT_EQ(hal::drive_state(0x0208), hal::DriveState::Fault);
  EXPECT_EQ(hal::drive_state(0x0207), hal::DriveState::QuickStop);
}

TEST(Canopen, SetsUpPdosAndEnablesTheDrive) {
  CanopenBench bench;
  bench.run(600);
  ASSERT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
  const std::vector<hal::CanFrame> expected{
      can_frame(0x601, {0x23, 0x00, 0x14, 0x01, 0x01, 0x02, 0x00, 0x80}),
      can_frame(0x601, {0x2F, 0x00, 0x16, 0x00, 0x00, 0x00, 0x00, 0x00}),
      can_frame(0x601, {0x23, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60}),
      can_frame(0x601, {0x23, 0x00, 0x16, 0x02, 0x20, 0x00, 0x7A, 0x60}),
      can_frame(0x601, {0x2F, 0x00, 0x16, 0x00, 0x02, 0x00, 0x00, 0x00}),
      can_frame(0x601, {0x2F, 0x00, 0x14, 0x02, 0x01, 0x00, 0x00, 0x00}),
      can_frame(0x601, {0x23, 0x00, 0x14, 0x01, 0x01, 0x02, 0x00, 0x00}),
      can_frame(0x601, {0x23, 0x00, 0x18, 0x01, 0x81, 0x01, 0x00, 0xC0})};  // bit 30 kept
  const auto& writes = bench.pan.writes;
  EXPECT_NE(std::search(writes.begin(), writes.end(), expected.begin(), expected.end()), writes.end());
  const std::vector<hal::CanFrame> enabling{can_frame(0x601, {0x2B, 0x40, 0x60, 0, 0x06, 0, 0, 0}),
                                            can_frame(0x601, {0x2B, 0x40, 0x60, 0, 0x07, 0, 0, 0}),
                                            can_frame(0x601, {0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0})};
  EXPECT_NE(std::search(writes.begin(), writes.end(), enabling.begin(), enabling.end()), writes.end());
}

TEST(Canopen, MovesByTheSetPointHandshake) {
  CanopenBench bench;
  bench.run(600);
  ASSERT_EQ(bench.driver->move(Axis::Pan, -0.25, 0.1), MoveStatus::Accepted);
  bench.run(150);
  const auto sent = bench.of(0x201);
  ASSERT_GE(sent.size(), 2U);
  EXPECT_EQ(sent[0], can_frame(0x201, {0x3F, 0x00, 0x58, 0x9E, 0xFF, 0xFF}));
  EXPECT_EQ(sent[1], can_frame(0x201, {0x0F, 0x00, 0x58, 0x9E, 0xFF, 0xFF}));
  EXPECT_TRUE(bench.driver->axis(Axis::Pan).moving);
  bench.pan.objects[0x606400] = -25000;
  bench.run(100);
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_NEAR(bench.driver->axis(Axis::Pan).position_rad, -0.25, 1e-9);
  std::array<hal::AxisSample, 64> samples{};
  EXPECT_GT(bench.driver->take(samples), 2U);
}

TEST(Canopen, AMoveStartsWhereTheAxisStoodAlsoWhenItIsSeenUnderWayBeforeItsConfirmation) {
  CanopenBench bench;
  bench.run(600);
  ASSERT_EQ(bench.driver->move(Axis::Pan, -0.25, 0.1), MoveStatus::Accepted);
  for (int i = 0; i < 100 && bench.of(0x201).empty(); ++i) {
    bench.run(1);
  }
  ASSERT_EQ(bench.of(0x201).size(), 1U);
  bench.pan.objects[0x606400] = -300;  // in the PDO that also acknowledges
  bench.run(150);
  ASSERT_TRUE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_EQ(bench.driver->axis(Axis::Pan).move.start_rad(), 0.0);
}

TEST(Canopen, FallsBackToSdoWhenNothingCanBeMapped) {
  CanopenBench bench;
  bench.pan.refused = 0x160000;
  bench.tilt.refused = 0x1A0000;
  bench.run(900);
  ASSERT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
  ASSERT_EQ(bench.driver->move(Axis::Pan, 0.1, 0.1), MoveStatus::Accepted);
  ASSERT_EQ(bench.driver->move(Axis::Tilt, 0.1, 0.1), MoveStatus::Accepted);
  bench.run(300);
  EXPECT_TRUE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_TRUE(bench.driver->axis(Axis::Tilt).moving);
  EXPECT_EQ(bench.counter("mappings_fixed"), 2U);
}

TEST(Canopen, NamesWhatWasLostAndStartsOver) {
  CanopenBench bench;
  bench.run(600);
  bench.link.deliver(can_frame(0x082, {0x10, 0x23, 0x02, 0, 0, 0, 0, 0}));
  bench.run(1);
  EXPECT_EQ(bench.driver->state(), DeviceState::Faulted);
  EXPECT_NE(bench.driver->problem().find("tilt axis: reports a current error"), std::string_view::npos);
  bench.run(1500);
  ASSERT_EQ(bench.driver->state(), DeviceState::Ready);
  bench.link.deliver(can_frame(0x701, {0x00}));
  bench.run(1);
  EXPECT_EQ(bench.driver->problem(), "CANopen pan axis: started anew by itself; check its power");
  bench.run(1500);
  ASSERT_EQ(bench.driver->state(), DeviceState::Ready);
  bench.pan.silent = true;
  bench.run(500);
  EXPECT_EQ(bench.driver->problem(), "CANopen pan axis: heartbeat lost; check power and cable");
  bench.pan.silent = false;
  bench.run(6000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
}

TEST(Canopen, CountsFramesOfAWrongLength) {
  CanopenBench bench;
  bench.run(600);
  bench.link.deliver(can_frame(0x181, {0x27, 0x06}));
  bench.link.deliver(can_frame(0x702, {}));
  bench.link.deliver(can_frame(0x081, {1}));
  bench.run(1);
  EXPECT_EQ(bench.counter("frames_malformed"), 3U);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
}

TEST(Canopen, SweepsBySpeedAndEndsByASetPoint) {
  hal::CanopenConfig config = CanopenBench::defaults();
  config.motion = hal::CanopenMotion::ProfileVelocity;
  CanopenBench bench(config);
  bench.run(600);
  ASSERT_EQ(bench.driver->move(Axis::Pan, -0.25, 0.1), MoveStatus::Accepted);
  bench.run(100);
  EXPECT_EQ(bench.pan.objects[0x606000], 3);
  EXPECT_EQ(bench.of(0x601).at(bench.of(0x601).size() - 3),
            can_frame(0x601, {0x23, 0xFF, 0x60, 0, 0xF0, 0xD8, 0xFF, 0xFF}));
  EXPECT_TRUE(bench.of(0x201).empty());
  bench.pan.objects[0x606400] = -24500;
  bench.run(100);
  EXPECT_EQ(bench.pan.objects[0x606000], 1);
  ASSERT_FALSE(bench.of(0x201).empty());
  EXPECT_EQ(bench.of(0x201)[0], can_frame(0x201, {0x3F, 0x00, 0x58, 0x9E, 0xFF, 0xFF}));
}

TEST(Canopen, HaltsBothAxes) {
  CanopenBench bench;
  bench.run(600);
  ASSERT_EQ(bench.driver->move(Axis::Pan, -0.25, 0.1), MoveStatus::Accepted);
  bench.run(100);
  ASSERT_EQ(bench.driver->halt(), MoveStatus::Accepted);
  bench.run(100);
  EXPECT_EQ(bench.of(0x201).back(), can_frame(0x201, {0x0F, 0x01, 0x58, 0x9E, 0xFF, 0xFF}));
  EXPECT_EQ(bench.of(0x202).back().data[1], 0x01);
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
}

TEST(Canopen, HomesWhenAsked) {
  hal::CanopenConfig config = CanopenBench::defaults();
  config.homing = hal::CanopenHoming::Always;
  config.pan.homing_method = config.tilt.homing_method = 37;
  CanopenBench bench(config);
  bench.run(1500);
  ASSERT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
  const auto& writes = bench.pan.writes;
  const std::vector<hal::CanFrame> homing{can_frame(0x601, {0x2F, 0x60, 0x60, 0, 6, 0, 0, 0}),
                                          can_frame(0x601, {0x2F, 0x98, 0x60, 0, 37, 0, 0, 0}),
                                          can_frame(0x601, {0x2B, 0x40, 0x60, 0, 0x1F, 0, 0, 0}),
                                          can_frame(0x601, {0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0}),
                                          can_frame(0x601, {0x2F, 0x60, 0x60, 0, 1, 0, 0, 0})};
  EXPECT_NE(std::search(writes.begin(), writes.end(), homing.begin(), homing.end()), writes.end());
}

TEST(Canopen, ADriveThatIsNotHomedIsRefusedWhereNoMethodIsGiven) {
  hal::CanopenConfig config = CanopenBench::defaults();
  config.homing = hal::CanopenHoming::IfNotHomed;
  CanopenBench bench(config);
  bench.run(1500);
  EXPECT_EQ(bench.driver->state(), DeviceState::Faulted);
  EXPECT_NE(bench.driver->problem().find("is not homed"), std::string_view::npos) << bench.driver->problem();
}

TEST(Canopen, ZeroTakenFromWhereAnAxisStandsIsNotTakenAnewAfterALoss) {
  hal::CanopenConfig config = CanopenBench::defaults();
  config.homing = hal::CanopenHoming::IfNotHomed;
  config.pan.homing_method = 37;
  config.tilt.homing_method = 35;
  CanopenBench bench(config);
  bench.run(1500);
  ASSERT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
  bench.pan.writes.clear();
  bench.link.deliver(can_frame(0x701, {0x00}));
  bench.run(3000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Faulted);
  EXPECT_NE(bench.driver->problem().find("lost its zero"), std::string_view::npos) << bench.driver->problem();
  for (const hal::CanFrame& write : bench.pan.writes) {
    EXPECT_FALSE(write.data[1] == 0x98 && write.data[2] == 0x60) << "homed anew";
  }
}

TEST(Canopen, RefusesWhatIsNoDriveAndResetsAFault) {
  CanopenBench bench;
  bench.pan.objects[0x100000] = 0x191;
  bench.tilt.objects[0x604100] = 0x0208;
  bench.run(600);
  EXPECT_EQ(bench.driver->state(), DeviceState::Faulted);
  EXPECT_NE(bench.driver->problem().find("not a CiA 402 drive"), std::string_view::npos);
  const auto& writes = bench.tilt.writes;
  const auto reset = can_frame(0x602, {0x2B, 0x40, 0x60, 0, 0x80, 0, 0, 0});
  EXPECT_NE(std::find(writes.begin(), writes.end(), reset), writes.end());
  bench.pan.objects[0x100000] = 0x20192;
  bench.run(6000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
  bench.link.set_up(false);
  bench.run(1);
  EXPECT_EQ(bench.driver->state(), DeviceState::Absent);
  bench.link.set_up(true);
  bench.run(1000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
}

TEST(Canopen, RefusesTwoAxesOnOneNode) {
  hal::CanopenConfig config;
  config.tilt.node = 1;
  ScriptedCanLink link;
  EXPECT_FALSE(hal::CanopenPanTilt::create(config, link));
}

TEST(Canopen, AsksTheHeapForNothingInAStep) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "the heap cannot be watched under a sanitizer";
  }
  CanopenBench bench;
  bench.run(600);
  ASSERT_EQ(bench.driver->move(Axis::Pan, -0.25, 0.1), MoveStatus::Accepted);
  std::uint64_t calls = 0;
  for (int i = 0; i < 500; ++i) {
    bench.run(1);
    const NoAllocScope scope;
    bench.driver->step(bench.now);
    calls += scope.heap_calls();
  }
  EXPECT_EQ(calls, 0U);
}

}  // namespace
}  // namespace slamsensor::tests
