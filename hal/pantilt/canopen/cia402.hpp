#pragma once

#include <cstdint>

namespace slamsensor::hal {

/// State of a drive as its statusword tells it (CiA 402, "finite state automaton").
enum class DriveState : std::uint8_t {
  NotReady,
  SwitchOnDisabled,
  ReadyToSwitchOn,
  SwitchedOn,
  OperationEnabled,
  QuickStop,
  FaultReaction,
  Fault,
  Unknown,  ///< bits that no state has
};

[[nodiscard]] DriveState drive_state(std::uint32_t statusword) noexcept;

namespace control {
inline constexpr std::uint16_t kDisableVoltage = 0x0000;
inline constexpr std::uint16_t kShutdown = 0x0006;
inline constexpr std::uint16_t kSwitchOn = 0x0007;
inline constexpr std::uint16_t kEnable = 0x000F;
inline constexpr std::uint16_t kStartBit = 0x0010;  ///< new set-point; start of homing
inline constexpr std::uint16_t kImmediatelyBit = 0x0020;
inline constexpr std::uint16_t kFaultReset = 0x0080;
inline constexpr std::uint16_t kHaltBit = 0x0100;
}  // namespace control

namespace status {
inline constexpr std::uint32_t kTargetReached = 1U << 10;
inline constexpr std::uint32_t kAcknowledge = 1U << 12;  ///< of a set-point; homing attained
inline constexpr std::uint32_t kError = 1U << 13;        ///< following error; homing error
}  // namespace status

enum class DriveMode : std::uint8_t { ProfilePosition = 1, ProfileVelocity = 3, Homing = 6 };

/// Whether object 6502 (`supported`) has the bit of `mode`.
[[nodiscard]] constexpr bool has_mode(std::uint32_t supported, DriveMode mode) noexcept {
  return ((supported >> (static_cast<unsigned>(mode) - 1U)) & 1U) != 0;
}

/// The controlword that brings a drive in `state` one state nearer to OperationEnabled.
[[nodiscard]] std::uint16_t towards_enabled(DriveState state) noexcept;

}  // namespace slamsensor::hal
