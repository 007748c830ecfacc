#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/head_profile.hpp"

#include <cstdint>
#include <string>

namespace slamsensor::tools {

/// What a drive does with a target position beyond its software limits.
enum class DriveLimitRule : std::uint8_t {
  Clamp,   ///< goes to the limit and says so (status bit 11)
  Refuse,  ///< aborts the SDO; from a PDO it is ignored
};

/// How long bit 12 of the statusword says "homing attained" in homing mode.
enum class DriveHomedBit : std::uint8_t {
  WhileTrue,    ///< as long as the drive knows where it stands
  UntilLeaving  ///< until another mode is set
};

/// Whether a host may map objects to PDOs.
enum class DriveMapping : std::uint8_t { Free, Fixed };

/// Bit 30 of a TPDO's COB-ID (no remote requests).
enum class DriveRemoteBit : std::uint8_t {
  Clear,
  Required,  ///< set, and a COB-ID without it is refused
};

/// One axis with its CANopen drive. Positions are in counts of the output side, speeds in counts/s,
/// accelerations in counts/s^2. The defaults are a quick pan axis of 409,600 counts a turn (3.2 arc seconds).
struct DriveSettings {
  std::uint8_t node_id = 1;
  std::string device_name = "CiA 402 pan-tilt axis";  ///< 1008h
  std::string software_version = "1.04";              ///< 100Ah
  std::uint32_t vendor_id = 0x0000'02E1;
  std::uint32_t product_code = 0x0000'4602;
  std::uint32_t revision = 0x0001'0004;
  std::uint32_t serial_number = 1;

  std::uint32_t encoder_counts = 4096;  ///< of a motor turn, 608Fh
  std::uint32_t gear_turns = 100;       ///< of the motor in one of the axis, 6091h
  double direction = 1.0;               ///< -1 when the axis turns against its counts

  long lower_limit = -182'044;  ///< 607Dh at power-up
  long upper_limit = 182'044;
  long switch_margin = 1138;  ///< from a software limit to its limit switch
  long stop_margin = 2276;    ///< from a software limit to the mechanical stop
  long index_pulse = 0;       ///< where one of the encoder's index pulses is, the others a motor turn apart
  long home_offset = 0;       ///< 607Ch at power-up: the position of home
  long start = 0;             ///< where the axis stands at the beginning
  DriveMemory memory = DriveMemory::Absolute;
  DriveHomedBit homed_bit = DriveHomedBit::WhileTrue;
  DriveLimitRule limit_rule = DriveLimitRule::Clamp;

  std::uint32_t max_speed = 341'333;  ///< 300 deg/s; the highest that 6081h takes
  std::uint32_t speed = 34'133;       ///< 6081h at power-up
  std::uint32_t acceleration = 1'137'778;
  std::uint32_t quick_stop = 4'551'111;  ///< 6085h
  std::uint32_t homing_speed = 22'756;   ///< 6099h:1; a tenth of it is 6099h:2
  std::uint32_t following_window = 500;  ///< 6065h

  DriveMapping mapping = DriveMapping::Free;
  DriveRemoteBit remote_bit = DriveRemoteBit::Clear;
  Delay sdo_latency{std::chrono::microseconds(300), std::chrono::microseconds(100)};
  Delay pdo_latency{std::chrono::microseconds(50), Stamp{}};  ///< from SYNC or change to the TPDO
  Stamp sync_latch{};  ///< from the end of SYNC to the latched moment; negative: an old position
  Stamp boot_time = std::chrono::milliseconds(500);
  DeviceBegin begin = DeviceBegin::PowerUp;
  std::uint16_t emergency_code = 0x2310;  ///< of an Emergency: continuous over-current

  /// Counts of the axis in a radian.
  [[nodiscard]] double counts_per_rad() const noexcept;
};

/// The pan and tilt axes of an emulated unit.
struct CanopenHeadSettings {
  DriveSettings pan;
  DriveSettings tilt;
};

/// Pan as node 1, +-160 deg, and tilt as node 2, -47 to +31 deg.
[[nodiscard]] CanopenHeadSettings canopen_head_settings();

}  // namespace slamsensor::tools
