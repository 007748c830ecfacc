#pragma once

#include "hal/rangefinder/rangefinder.hpp"
#include "tests/support/scripted_link.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tests {

using hal::Stamp;
using std::chrono::milliseconds;

/// A rangefinder driver, the line and a device on it that a test plays: to each request it answers with
/// bytes, and for each millisecond it says what it sends by itself.
struct RangeBench {
  ScriptedLink link;
  std::unique_ptr<hal::Rangefinder> driver;
  std::uint32_t device_baud = 115200;
  bool has_line_rate = true;  // false: the device hears and is heard at every rate, as over USB or a network
  std::function<std::string(const std::string& request)> on_request = [](const std::string&) { return ""; };
  std::function<std::string(int millisecond)> on_tick = [](int) { return ""; };
  std::vector<ScriptedLink::Written> writes;
  std::vector<hal::RangeSample> samples;
  Stamp now = milliseconds(1000);
  Stamp busy_until{};
  int ticks = 0;

  RangeBench() { link.set_up(true); }

  void send(const std::string& bytes) {
    // A host at another rate gets other bytes.
    std::string seen = bytes;
    if (has_line_rate && link.baud() != device_baud) {
      for (char& c : seen) {
        c = static_cast<char>(c ^ 0x5B);
      }
    }
    busy_until = std::max(busy_until, now);
    link.deliver(seen, busy_until, device_baud);
    busy_until += hal::line_time(seen.size(), device_baud);
  }

  void run(int milliseconds_more) {
    for (int i = 0; i < milliseconds_more; ++i) {
      now += milliseconds(1);
      link.set_now(now);
      driver->step(now);
      for (const ScriptedLink::Written& write : link.take_writes()) {
        writes.push_back(write);
        if (!has_line_rate || write.baud == device_baud) {
          const std::string reply = on_request(write.text);
          send(reply);
        }
      }
      send(on_tick(ticks++));
      std::array<hal::RangeSample, 512> some{};
      const std::size_t count = driver->take(some);
      samples.insert(samples.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
    }
  }

  bool run_until_ready(int most_milliseconds) {
    for (int i = 0; i < most_milliseconds && driver->state() != hal::DeviceState::Ready; ++i) {
      run(1);
    }
    return driver->state() == hal::DeviceState::Ready;
  }

  [[nodiscard]] std::uint64_t counter(std::string_view name) const {
    for (const hal::Counter& counter : driver->counters()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    return ~std::uint64_t{0};
  }

  [[nodiscard]] bool was_written(const std::string& bytes) const {
    for (const auto& write : writes) {
      if (write.text == bytes) {
        return true;
      }
    }
    return false;
  }
};

}  // namespace slamsensor::tests
