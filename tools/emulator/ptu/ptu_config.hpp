#pragma once

#include "tools/emulator/ptu/ptu_settings.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace slamsensor::tools {

/// Numbered as in the binary interface.
enum class PtuPower : std::uint8_t { High = 1, Regular = 2, Low = 3, Off = 4 };
enum class PtuControl : std::uint8_t { Independent = 1, Velocity = 2 };

enum class PtuExecution : std::uint8_t { Immediate, Slaved };
enum class PtuLimits : std::uint8_t { Factory, User, Disabled };
enum class PtuEcho : std::uint8_t { On, Off };
enum class PtuFeedback : std::uint8_t { Verbose, Terse };
enum class PtuSwitch : std::uint8_t { On, Off };

/// Which axes are reset.
struct PtuAxes {
  bool pan = true;
  bool tilt = true;
  [[nodiscard]] bool any() const noexcept { return pan || tilt; }
};

/// What can be set of an axis. Positions/s, positions/s^2, positions.
struct PtuAxisConfig {
  long speed = 0;
  long acceleration = 0;
  long base_speed = 0;
  long lower_speed = 0;
  long upper_speed = 0;
  std::optional<long> user_min;
  std::optional<long> user_max;
  PtuPower hold_power = PtuPower::Low;
  PtuPower move_power = PtuPower::Regular;
  char step_mode = 'H';  ///< F, H, Q, E, A: full, half, quarter, eighth, automatic
};

/// What the automatic scan goes between; of the tilt axis only when both are given.
struct PtuMonitorRange {
  long pan_from = 0;
  long pan_to = 0;
  std::optional<std::array<long, 2>> tilt;
};

/// All that DS saves, DR brings back, and DF and the factory set.
struct PtuConfig {
  std::array<PtuAxisConfig, kPtuAxes> axes;
  PtuEcho echo = PtuEcho::On;
  PtuFeedback feedback = PtuFeedback::Verbose;
  PtuLimits limits = PtuLimits::Factory;
  PtuControl control = PtuControl::Independent;
  PtuExecution execution = PtuExecution::Immediate;
  PtuAxes power_up_reset;
  std::optional<PtuMonitorRange> monitor;  ///< as last defined
  PtuSwitch monitor_at_power_up = PtuSwitch::Off;
  PtuSwitch compatibility = PtuSwitch::On;
  std::array<long, kPtuAxes> reset_speeds{};  ///< RPS, RTS; 0: the time of the settings
  std::uint8_t unit_id = 0;
  std::uint32_t start_baud = 9600;
};

[[nodiscard]] PtuConfig factory_config(const PtuSettings& settings);

[[nodiscard]] inline const PtuAxisModel& model_of(const PtuSettings& settings, PtuAxisId axis) noexcept {
  return axis == PtuAxisId::Pan ? settings.model.pan : settings.model.tilt;
}

}  // namespace slamsensor::tools
