#pragma once

#include "tools/emulator/canopen/drive_objects.hpp"

#include <cstdint>
#include <vector>

namespace slamsensor::tools {

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
[[nodiscard]] SdoAbort check_pdo_write(const ObjectDictionary& objects, const DriveSettings& settings,
                                       ObjectKey key, std::int64_t value);

}  // namespace slamsensor::tools
