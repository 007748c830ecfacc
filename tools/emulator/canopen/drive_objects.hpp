#pragma once

#include "tools/emulator/canopen/drive_axis.hpp"
#include "tools/emulator/canopen/emulated_node.hpp"

#include <cstdint>
#include <vector>

namespace slamsensor::tools {

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
