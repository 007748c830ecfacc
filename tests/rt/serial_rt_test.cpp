// Drivers on real serial ports: the system calls of SerialPort, on pseudo-terminals with an emulated head at
// their other ends, cost the scan thread no memory and no page fault either, from the opening of the ports
// on.
#include "hal/clock.hpp"
#include "hal/transport/serial_port.hpp"
#include "tests/rt/taped_head.hpp"
#include "tests/support/busy_head.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <poll.h>
#include <string>
#include <utility>

namespace slamsensor::tests {
namespace {

using namespace std::chrono_literals;

constexpr hal::Stamp kPatience = 60s;  // start-ups take about four
constexpr hal::Stamp kWork = 3s;       // of both devices Ready
constexpr std::size_t kStackMax_bytes = 64 * 1024;

/// Steps until both devices have been at work for a while.
void work(HeadRun& run) noexcept {
  const auto is_ready = [&] {
    return run.drivers().pan_tilt->state() == hal::DeviceState::Ready &&
           run.drivers().rangefinder->state() == hal::DeviceState::Ready;
  };
  const hal::Stamp begun = hal::monotonic_now();
  hal::Stamp ready_since = hal::kNever;
  for (hal::Stamp now = begun; now < begun + kPatience; now = hal::monotonic_now()) {
    run.step(now);
    ready_since = is_ready() ? std::min(ready_since, now) : hal::kNever;
    if (ready_since != hal::kNever && now > ready_since + kWork) {
      return;
    }
    poll(nullptr, 0, 1);
  }
}

std::unique_ptr<hal::SerialPort> port_at(const std::string& path, std::uint32_t baud) {
  hal::SerialConfig config;
  config.path = path;
  config.line.baud = baud;
  auto port = hal::SerialPort::create(config);
  EXPECT_TRUE(port) << port.error().message;
  return std::move(*port);
}

TEST(SerialPortsInRealTime, CostNoMemoryAndNoPageFault) {
  tools::Scenario scenario;
  scenario.head = tools::head_profile(tools::HeadKind::Fast);
  scenario.head.ptu.begin = tools::DeviceBegin::Ready;
  scenario.drive.stands = 1;
  const BusyHead head(scenario);
  const auto unit = port_at(head.unit_path(), scenario.head.ptu.baud);
  const auto finder = port_at(head.finder_path(), scenario.head.rangefinder.baud);
  DriversRun run({unit.get(), nullptr, finder.get(), nullptr}, scenario.head);
  const bool is_held = hold_memory();
  const Cost cost = cost_of([&] { work(run); });
  ASSERT_EQ(run.drivers().pan_tilt->state(), hal::DeviceState::Ready) << run.drivers().pan_tilt->problem();
  ASSERT_EQ(run.drivers().rangefinder->state(), hal::DeviceState::Ready)
      << run.drivers().rangefinder->problem();
  EXPECT_GT(run.readings, 1000U);
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: all was stepped, but a sanitizer's heap and stack are not those of the product";
  }
  EXPECT_EQ(cost.heap_calls, 0U);
  EXPECT_LT(cost.stack_bytes, kStackMax_bytes);
  if (!is_held) {
    GTEST_SKIP() << "SKIPPED: memory can neither be locked (ulimit -l) nor populated (Linux 5.14) here";
  }
  EXPECT_EQ(cost.page_faults, 0U);
}

}  // namespace
}  // namespace slamsensor::tests
