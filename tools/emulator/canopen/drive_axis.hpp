#pragma once

#include "tools/emulator/canopen/emulated_node.hpp"
#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/ptu/motion_plan.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace slamsensor::tools {

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
  long home_offset = 0;       ///< 607Ch at power-up: the position of home
  long start = 0;             ///< where the axis stands at the beginning
  DriveMemory memory = DriveMemory::Absolute;

  std::uint32_t max_speed = 341'333;  ///< 300 deg/s; the highest that 6081h takes
  std::uint32_t speed = 34'133;       ///< 6081h at power-up
  std::uint32_t acceleration = 1'137'778;
  std::uint32_t quick_stop = 4'551'111;  ///< 6085h
  std::uint32_t homing_speed = 22'756;   ///< 6099h:1; a tenth of it is 6099h:2
  std::uint32_t following_window = 500;  ///< 6065h

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

/// How a drive moves: never faster than `speed`, with ramps of their own up and down (CiA 402, linear ramp
/// profile). Counts/s and counts/s^2, all positive.
struct DriveRates {
  double speed = 0.0;
  double acceleration = 1.0;
  double deceleration = 1.0;
};

/// A motion and when, from its begin, it has settled: at rest, or at its speed.
struct DriveProfile {
  MotionPlan plan;
  double settled_s = 0.0;
};

/// The fastest way from `state` to rest at `target`; settled at its end.
[[nodiscard]] DriveProfile plan_profile(StepperState state, double target, const DriveRates& rates);

/// At the speed of `rates` towards `bound`, where it stops; settled when the speed is reached.
[[nodiscard]] DriveProfile plan_run(const StepperState& state, double bound, const DriveRates& rates);

/// The shortest way to rest.
[[nodiscard]] DriveProfile plan_rest(const StepperState& state, double deceleration);

/// `second`, which begins where `first` ends, right after it.
[[nodiscard]] DriveProfile then(DriveProfile first, const DriveProfile& second);

/// How fast an axis looks for its home.
struct HomingRates {
  double fast = 0.0;  ///< until the switch
  double slow = 0.0;  ///< back, to the edge or the index pulse
  double acceleration = 1.0;
};

/// The mechanics of a drive: motor, encoder, limit switches, stops. The encoder is on the motor, so what it
/// counts is true but for where it counts from.
class DriveAxis {
 public:
  explicit DriveAxis(const DriveSettings& settings);

  [[nodiscard]] double position(Stamp at) const { return motion_.position(at); }
  [[nodiscard]] double speed(Stamp at) const { return motion_.speed(at); }
  [[nodiscard]] double truth(Stamp at) const { return motion_.truth(at); }
  [[nodiscard]] bool is_moving(Stamp at) const { return motion_.still_from() > at; }
  [[nodiscard]] Stamp still_from() const { return motion_.still_from(); }

  /// When the last command is done: at rest, or at its speed.
  [[nodiscard]] Stamp settled_at() const { return settled_at_; }

  void move(Stamp at, double target, const DriveRates& rates);
  void run(Stamp at, double bound, const DriveRates& rates);
  void stop(Stamp at, double deceleration);

  /// Stands still at once: the brake holds it, or an obstacle.
  void freeze(Stamp at);

  /// Looks for home as homing method `method` says (CiA 402: 17 lower and 18 upper limit switch, 35 and 37
  /// here); false for other methods.
  [[nodiscard]] bool home(Stamp at, long method, const HomingRates& rates);

  /// Counts from now on so that it is at `position`. It rests.
  void set_position(Stamp at, double position);

  /// When it runs into a mechanical stop; kNever when it does not.
  [[nodiscard]] Stamp stop_hit() const { return hit_at_; }

  /// When the present motion would be `window` away from where it is at `at`; kNever when it ends before.
  [[nodiscard]] Stamp gets_away(Stamp at, double window) const;

  void forget(Stamp before) { motion_.forget(before); }

 private:
  void follow(Stamp at, const DriveProfile& profile);
  [[nodiscard]] DriveProfile to_switch(const StepperState& state, double edge, double direction,
                                       const HomingRates& rates) const;

  const DriveSettings& settings_;
  Trajectory motion_;
  Stamp settled_at_ = Stamp::min();
  Stamp hit_at_ = hal::kNever;
};

/// PDOs of either direction, and objects in one.
inline constexpr std::uint16_t kDrivePdos = 4;
inline constexpr std::uint8_t kPdoEntriesMax = 8;

/// Errors that 1003h remembers.
inline constexpr std::uint8_t kErrorHistory = 8;

namespace object {
inline constexpr ObjectKey kErrorRegister{0x1001, 0};
inline constexpr ObjectKey kSyncId{0x1005, 0};
inline constexpr ObjectKey kEmergencyId{0x1014, 0};
inline constexpr ObjectKey kHeartbeat_ms{0x1017, 0};
inline constexpr ObjectKey kErrorCode{0x603F, 0};
inline constexpr ObjectKey kControlword{0x6040, 0};
inline constexpr ObjectKey kStatusword{0x6041, 0};
inline constexpr ObjectKey kQuickStopOption{0x605A, 0};
inline constexpr ObjectKey kMode{0x6060, 0};
inline constexpr ObjectKey kModeDisplay{0x6061, 0};
inline constexpr ObjectKey kPosition{0x6064, 0};
inline constexpr ObjectKey kFollowingWindow{0x6065, 0};
inline constexpr ObjectKey kVelocity{0x606C, 0};
inline constexpr ObjectKey kTarget{0x607A, 0};
inline constexpr ObjectKey kHomeOffset{0x607C, 0};
inline constexpr ObjectKey kLowerLimit{0x607D, 1};
inline constexpr ObjectKey kUpperLimit{0x607D, 2};
inline constexpr ObjectKey kProfileSpeed{0x6081, 0};
inline constexpr ObjectKey kAcceleration{0x6083, 0};
inline constexpr ObjectKey kDeceleration{0x6084, 0};
inline constexpr ObjectKey kQuickStop{0x6085, 0};
inline constexpr ObjectKey kHomingMethod{0x6098, 0};
inline constexpr ObjectKey kHomingFast{0x6099, 1};
inline constexpr ObjectKey kHomingSlow{0x6099, 2};
inline constexpr ObjectKey kHomingAcceleration{0x609A, 0};
inline constexpr ObjectKey kTargetVelocity{0x60FF, 0};
}  // namespace object

/// The dictionary of a drive at power-up: communication (CiA 301), device profile (CiA 402), and the PDO
/// maps that Faulhaber's drives come with (control and status word alone, with position, with velocity).
[[nodiscard]] ObjectDictionary drive_objects(const DriveSettings& settings);

/// An object in a PDO.
struct PdoEntry {
  ObjectKey key;
  std::uint8_t width = 0;  ///< bytes
};

/// Objects 1400h-1403h and 1600h-1603h, or 1800h-1803h and 1A00h-1A03h, as one of a node's PDOs.
class DrivePdo {
 public:
  /// `communication` is the index of its communication parameters; `objects` outlives it.
  DrivePdo(const ObjectDictionary& objects, std::uint16_t communication)
      : objects_(objects), communication_(communication) {}

  [[nodiscard]] bool is_valid() const { return (id_word() & 0x8000'0000) == 0; }
  [[nodiscard]] std::uint32_t id() const { return static_cast<std::uint32_t>(id_word() & 0x7FF); }
  [[nodiscard]] std::uint8_t type() const;
  [[nodiscard]] Stamp inhibit() const;
  [[nodiscard]] Stamp event_time() const;
  [[nodiscard]] std::vector<PdoEntry> entries() const;

 private:
  [[nodiscard]] std::int64_t parameter(std::uint8_t sub) const {
    return objects_.value({communication_, sub});
  }
  [[nodiscard]] std::int64_t id_word() const { return parameter(1); }

  const ObjectDictionary& objects_;
  std::uint16_t communication_;
};

/// Whether `index` is of a PDO's parameters.
[[nodiscard]] bool is_pdo_object(std::uint16_t index) noexcept;

/// Whether a host may write `value` there now (CiA 301, PDO configuration): the identifier and the inhibit
/// time only of an invalid PDO, the map only of an invalid PDO without entries, entries that exist, may be
/// mapped that way and have this length, 8 bytes in all.
[[nodiscard]] SdoAbort check_pdo_write(const ObjectDictionary& objects, ObjectKey key, std::int64_t value);

}  // namespace slamsensor::tools
