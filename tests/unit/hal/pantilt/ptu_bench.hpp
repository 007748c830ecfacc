#pragma once

#include "hal/pantilt/ptu_driver.hpp"
#include "tests/support/scripted_link.hpp"
#include "tests/unit/hal/pantilt/ptu_script.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace slamsensor::tests {

/// A driver with its unit, in simulated time.
class PtuBench {
 public:
  explicit PtuBench(hal::PtuConfig config = {});

  /// Steps every `period` until `end` or `until` holds; returns whether it did.
  bool run(
      hal::Stamp length, const std::function<bool()>& until = [] { return false; });
  bool run_until_ready(hal::Stamp length = std::chrono::seconds(20));

  /// Moves and takes samples until the axis stands; returns the samples.
  std::vector<hal::AxisSample> sweep(hal::Axis axis, int target, double speed_ps);
  std::vector<hal::AxisSample> take();

  [[nodiscard]] std::uint64_t counter(std::string_view name) const;
  [[nodiscard]] double rad(double positions) const;

  ScriptedLink link;
  PtuScript unit;
  std::unique_ptr<hal::PtuDriver> driver;
  hal::Stamp now = std::chrono::seconds(100);
  hal::Stamp period = std::chrono::milliseconds(1);
};

/// Checks of every sample that the axis really was there within the stamp's half width.
void expect_true(const std::vector<hal::AxisSample>& samples, const PtuScript& unit, double position_rad);

/// Checks that the unit is set up as a start-up promises, with the facts of the script, and that nothing was
/// sent that must not be.
void expect_set_up(const PtuBench& bench);

}  // namespace slamsensor::tests
