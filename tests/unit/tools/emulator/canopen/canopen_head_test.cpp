// Set-points in a row, and both axes on a bus under random frames and faults.
#include "tests/unit/tools/emulator/canopen/canopen_rig.hpp"
#include "tools/emulator/memory_can_bus.hpp"
#include "tools/world/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;

TEST(EmulatedDrive, TakesASecondSetPointHaltsAndGoesOn) {
  DriveRig rig(DriveRig::ready());
  const auto counts = [&] {
    return std::lround(rig.drive.angle_rad(rig.now) * rig.ready().counts_per_rad());
  };
  const auto control = [&](const char* word) { rig.ask(std::string("201 ") + word); };
  rig.ask("601 2F 60 60 00 01 00 00 00");
  rig.ask("601 23 81 60 00 10 27 00 00");
  rig.ask("000 01 00");
  control("0F 00");
  control("06 00");
  control("0F 00");
  rig.ask("601 23 7A 60 00 10 27 00 00");
  control("1F 00");
  control("0F 00");
  rig.ask("601 23 7A 60 00 E8 03 00 00");
  EXPECT_EQ(rig.ask("201 5F 00").substr(0, 10), "181 37 12 ");  // 1000 further, after the first
  control("0F 00");
  rig.pass(500ms);
  control("0F 01");
  rig.pass(200ms);
  const long halted = counts();
  EXPECT_GT(halted, 4000);
  EXPECT_LT(halted, 6000);
  rig.pass(200ms);
  EXPECT_EQ(counts(), halted);
  control("0F 00");
  rig.pass(3s);
  EXPECT_EQ(counts(), 11'000);
  rig.ask("601 23 7A 60 00 00 00 00 00");
  control("1F 00");
  control("0F 00");
  rig.ask("601 23 7A 60 00 20 4E 00 00");
  control("3F 00");  // at once
  rig.pass(2s);
  EXPECT_EQ(counts(), 20'000);
}

// The frames that two equal runs bring to the host.
std::vector<std::string> run(std::uint64_t seed) {
  MemoryCanBus bus;
  const std::size_t host = bus.add_host();
  FrameSink& pan = bus.add_device_node();
  FrameSink& tilt = bus.add_device_node();
  EmulatedCanopenHead head(canopen_head_settings(), pan, tilt, seed);
  bus.attach(pan, head.pan());
  bus.attach(tilt, head.tilt());
  Random rng(seed);
  std::vector<std::string> heard;
  constexpr std::array<std::uint32_t, 7> kIds = {0, 0x80, 0x201, 0x302, 0x401, 0x601, 0x602};
  constexpr std::array<std::uint8_t, 12> kLikely = {0x40, 0x60, 0x2B, 0x0F, 0x1F, 0x06,
                                                    0,    1,    3,    0x80, 0xFF, 2};
  HeadAngles before;
  for (Stamp now = 1ms; now < 20s; now += 1ms) {
    bus.advance(now);
    hal::CanFrame frame{.id = kIds[rng() % kIds.size()], .extended = false};
    frame.size = frame.id == 0 ? 2 : 8;
    for (std::uint8_t& byte : frame.data) {
      byte = kLikely[rng() % kLikely.size()];
    }
    if (frame.id != 0 || rng() % 50 == 0) {
      static_cast<void>(bus.host_send(host, frame, now));
    }
    if (rng() % 500 == 0) {
      static_cast<void>(head.inject({static_cast<FaultKind>(rng() % kFaultKinds), now, 100ms}));
    }
    while (const auto arrival = bus.host_take(host)) {
      heard.push_back(DriveRig::text_of(arrival->frame));
    }
    const HeadAngles angles = head.angles_at(now);
    EXPECT_LT(std::abs(angles.pan_rad - before.pan_rad), 0.006) << "seed " << seed;
    EXPECT_LT(std::abs(angles.tilt_rad - before.tilt_rad), 0.006) << "seed " << seed;
    before = angles;
  }
  return heard;
}

TEST(EmulatedCanopenHead, GoesOnAndRepeatsWhateverItHears) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<std::string> heard = run(seed);
    EXPECT_GT(heard.size(), 1000U) << "seed " << seed;
    EXPECT_EQ(heard, run(seed)) << "seed " << seed;
    EXPECT_NE(std::ranges::find(heard, "702 00"), heard.end()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace slamsensor::tools
