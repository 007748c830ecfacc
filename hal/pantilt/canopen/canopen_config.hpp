#pragma once

#include "hal/init_error.hpp"
#include "hal/stamp.hpp"

#include <cstdint>
#include <optional>

namespace slamsensor::hal {

/// Which way an axis counts: Normal is pan positive to the left and tilt positive upwards.
enum class CanopenSense : std::uint8_t { Normal, Reversed };

/// When a start-up drives an axis to its reference (CiA 402 homing mode).
enum class CanopenHoming : std::uint8_t {
  Never,       ///< for absolute encoders alone: what the drive reports is believed
  IfNotHomed,  ///< bit 12 of the statusword, in homing mode, does not say "attained"
  Always,
};

/// How positions come.
enum class CanopenFeedback : std::uint8_t {
  Automatic,   ///< the first of the next three that the node can do
  MappedPdo,   ///< a PDO mapped by the driver
  DefaultPdo,  ///< a PDO of the node that has both statusword and position in its map
  Sdo,         ///< asked for one by one
};

/// When a node sends its position PDO.
enum class CanopenPdoTiming : std::uint8_t { Sync, Event };

/// How a move is driven.
enum class CanopenMotion : std::uint8_t {
  ProfilePosition,
  /// Constant rate by profile velocity, then profile position for the rest of the way. Needs mode 3.
  ProfileVelocity,
};

enum class CanopenFaultReset : std::uint8_t { Never, AtStart };

/// Where the scale of an axis comes from.
enum class CanopenScale : std::uint8_t {
  Configured,
  FromDrive,  ///< objects 608F (encoder) and 6091 (gear)
};

struct CanopenAxisConfig {
  std::uint8_t node = 1;  ///< 1..127
  CanopenSense sense = CanopenSense::Normal;
  CanopenScale scale = CanopenScale::Configured;
  double counts_per_rad = 100'000.0;        ///< positions; positive
  double speed_units_per_rad = 0.0;         ///< of 6081 and 60FF, per rad/s; 0: counts per second
  double acceleration_units_per_rad = 0.0;  ///< of 6083 and 6084, per rad/s^2; 0: counts per second squared
  double min_rad = -3.0;  ///< allowed here; the drive's own limits (607D), where it has them, narrow it
  double max_rad = 3.0;
  double speed_max_radps = 1.0;      ///< allowed here; the drive's 607F, where it has one, lowers it
  double acceleration_radps2 = 0.0;  ///< set in the drive; 0: the drive's own is read and kept
  double window_rad = 0.001;         ///< a move has ended within this of its target
  /// Object 6098, by the manufacturer's table; 0: none, and a drive that says that it is not homed is
  /// refused. Methods 35 and 37 take zero from where the axis stands: done once, they are refused after a
  /// loss.
  std::int8_t homing_method = 0;
};

/// How to talk to a pan-tilt unit of two CiA 402 drives on one CANopen bus.
struct CanopenConfig {
  CanopenAxisConfig pan{.node = 1};
  CanopenAxisConfig tilt{.node = 2, .min_rad = -1.5, .max_rad = 1.5};

  CanopenHoming homing = CanopenHoming::IfNotHomed;
  CanopenFaultReset fault_reset = CanopenFaultReset::AtStart;
  CanopenFeedback feedback = CanopenFeedback::Automatic;
  CanopenPdoTiming pdo_timing = CanopenPdoTiming::Sync;
  CanopenMotion motion = CanopenMotion::ProfilePosition;

  double poll_hz = 50.0;      ///< of SYNC and of a moving axis, 1..1000
  double rest_poll_hz = 2.0;  ///< positions of a resting axis handed out, 0.1..poll_hz

  Stamp heartbeat = std::chrono::milliseconds(100);          ///< asked of the nodes, 10 ms..30 s
  Stamp heartbeat_timeout = std::chrono::milliseconds(350);  ///< longer than `heartbeat`
  Stamp sdo_timeout = std::chrono::milliseconds(200);
  std::uint8_t sdo_attempts = 3;                     ///< 1..10
  Stamp boot_wait = std::chrono::milliseconds(100);  ///< from boot-up or NMT command to the first SDO
  Stamp state_timeout = std::chrono::seconds(2);     ///< of one change of the drive's state
  Stamp homing_timeout = std::chrono::seconds(60);
  Stamp acknowledge_timeout = std::chrono::milliseconds(500);  ///< of a set-point
  Stamp position_timeout = std::chrono::seconds(1);            ///< silence of positions that is a loss
  Stamp retry_first = std::chrono::milliseconds(250);          ///< back-off of start-ups, doubled up to
  Stamp retry_longest = std::chrono::seconds(5);

  /// How unsure the moment is at which a drive latches its position for a SYNC.
  Stamp sync_half_width = std::chrono::microseconds(500);
};

/// Which figure of `config` is out of its bounds; nothing when all are within.
[[nodiscard]] std::optional<InitError> canopen_config_error(const CanopenConfig& config);

}  // namespace slamsensor::hal
