#pragma once

#include <cstdint>

namespace slamsensor::hal {

/// Where a value lies in a node's object dictionary.
struct SdoAddress {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend constexpr bool operator==(const SdoAddress&, const SdoAddress&) = default;
};

/// Objects of CiA 301 (communication) and CiA 402 (drives).
namespace object {
inline constexpr SdoAddress kDeviceType{0x1000, 0};
inline constexpr SdoAddress kErrorRegister{0x1001, 0};
inline constexpr SdoAddress kDeviceName{0x1008, 0};
inline constexpr SdoAddress kHeartbeatTime{0x1017, 0};  // ms, 16 bits
inline constexpr SdoAddress kVendor{0x1018, 1};
inline constexpr SdoAddress kProduct{0x1018, 2};
inline constexpr SdoAddress kControlword{0x6040, 0};
inline constexpr SdoAddress kStatusword{0x6041, 0};
inline constexpr SdoAddress kMode{0x6060, 0};
inline constexpr SdoAddress kModeDisplay{0x6061, 0};
inline constexpr SdoAddress kPosition{0x6064, 0};
inline constexpr SdoAddress kTarget{0x607A, 0};
inline constexpr SdoAddress kPositionMin{0x607D, 1};
inline constexpr SdoAddress kPositionMax{0x607D, 2};
inline constexpr SdoAddress kSpeedMax{0x607F, 0};
inline constexpr SdoAddress kProfileSpeed{0x6081, 0};
inline constexpr SdoAddress kAcceleration{0x6083, 0};
inline constexpr SdoAddress kDeceleration{0x6084, 0};
inline constexpr SdoAddress kEncoderCounts{0x608F, 1};
inline constexpr SdoAddress kEncoderTurns{0x608F, 2};
inline constexpr SdoAddress kGearMotorTurns{0x6091, 1};
inline constexpr SdoAddress kGearShaftTurns{0x6091, 2};
inline constexpr SdoAddress kHomingMethod{0x6098, 0};
inline constexpr SdoAddress kTargetSpeed{0x60FF, 0};
inline constexpr SdoAddress kSupportedModes{0x6502, 0};
}  // namespace object

/// Identifiers of the predefined connection set (CiA 301), to which the node's number is added.
namespace cob {
inline constexpr std::uint32_t kNmt = 0x000;
inline constexpr std::uint32_t kSync = 0x080;
inline constexpr std::uint32_t kEmergency = 0x080;
inline constexpr std::uint32_t kTransmitPdo = 0x180;
inline constexpr std::uint32_t kReceivePdo = 0x200;
inline constexpr std::uint32_t kSdoReply = 0x580;
inline constexpr std::uint32_t kSdoRequest = 0x600;
inline constexpr std::uint32_t kHeartbeat = 0x700;
}  // namespace cob

enum class NmtCommand : std::uint8_t {
  Start = 0x01,
  Stop = 0x02,
  PreOperational = 0x80,
  ResetNode = 0x81,
  ResetCommunication = 0x82,
};

enum class NmtState : std::uint8_t {
  BootUp = 0x00,
  Stopped = 0x04,
  Operational = 0x05,
  PreOperational = 0x7F,
};

inline constexpr std::uint8_t kNodeMax = 127;

/// State of a drive as its statusword reports it (CiA 402, "finite state automaton").
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
