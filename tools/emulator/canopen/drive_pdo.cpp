#include "tools/emulator/canopen/drive_pdo.hpp"

namespace slamsensor::tools {
namespace {

constexpr std::int64_t kInvalid = 0x8000'0000;
constexpr std::int64_t kNoRemote = 0x4000'0000;
constexpr std::int64_t kExtended = 0x2000'0000;
constexpr std::int64_t kIdBits = 0x7FF;

bool is_transmit(std::uint16_t index) noexcept {
  return index >= 0x1800;
}

bool is_map(std::uint16_t index) noexcept {
  return (index & 0x0200U) != 0;
}

PdoEntry entry_of(std::int64_t word) noexcept {
  return {{static_cast<std::uint16_t>(word >> 16), static_cast<std::uint8_t>(word >> 8)},
          static_cast<std::uint8_t>((word & 0xFF) / 8)};
}

SdoAbort check_entry(const ObjectDictionary& objects, std::int64_t word, ObjectMapping way) {
  const PdoEntry entry = entry_of(word);
  const CanObject* const mapped = objects.find(entry.key);
  if (mapped == nullptr) {
    return objects.missing(entry.key);
  }
  const bool fits = mapped->mapping == way || mapped->mapping == ObjectMapping::Both;
  return fits && (word & 0xFF) == 8 * width_of(mapped->type) ? SdoAbort::None : SdoAbort::NotMappable;
}

SdoAbort check_map(const ObjectDictionary& objects, const DriveSettings& settings, ObjectKey key,
                   std::int64_t value) {
  const ObjectMapping way = is_transmit(key.index) ? ObjectMapping::Transmit : ObjectMapping::Receive;
  if (settings.mapping == DriveMapping::Fixed) {
    return SdoAbort::NotMappable;
  }
  if (DrivePdo(objects, static_cast<std::uint16_t>(key.index - 0x200)).is_valid()) {
    return SdoAbort::UnsupportedAccess;
  }
  if (key.sub != 0) {
    const bool is_open = objects.value({key.index, 0}) == 0;
    return is_open ? check_entry(objects, value, way) : SdoAbort::UnsupportedAccess;
  }
  if (value > kPdoEntriesMax) {
    return SdoAbort::MappingTooLong;
  }
  int bytes = 0;
  for (std::uint8_t sub = 1; sub <= value; ++sub) {
    const std::int64_t word = objects.value({key.index, sub});
    if (check_entry(objects, word, way) != SdoAbort::None) {
      return SdoAbort::NotMappable;
    }
    bytes += entry_of(word).width;
  }
  return bytes <= 8 ? SdoAbort::None : SdoAbort::MappingTooLong;
}

SdoAbort check_id(const DrivePdo& pdo, const DriveSettings& settings, ObjectKey key, std::int64_t value) {
  const bool needs_bit = is_transmit(key.index) && settings.remote_bit == DriveRemoteBit::Required;
  const bool changes = pdo.is_valid() && (value & kInvalid) == 0 && (value & kIdBits) != pdo.id();
  const bool has_strange_bits = (value & kExtended) != 0 || (value & 0x1FFF'F800) != 0;
  const bool is_bad = changes || has_strange_bits || (needs_bit && (value & kNoRemote) == 0);
  return is_bad ? SdoAbort::ValueRange : SdoAbort::None;
}

}  // namespace

std::uint8_t DrivePdo::type() const {
  return static_cast<std::uint8_t>(parameter(2));
}

Stamp DrivePdo::inhibit() const {
  return std::chrono::microseconds(100 * parameter(3));
}

Stamp DrivePdo::event_time() const {
  return std::chrono::milliseconds(parameter(5));
}

std::vector<PdoEntry> DrivePdo::entries() const {
  const auto map = static_cast<std::uint16_t>(communication_ + 0x200);
  std::vector<PdoEntry> entries;
  for (std::uint8_t sub = 1; sub <= objects_.value({map, 0}); ++sub) {
    entries.push_back(entry_of(objects_.value({map, sub})));
  }
  return entries;
}

bool is_pdo_object(std::uint16_t index) noexcept {
  return index >= 0x1400 && index < 0x1C00;
}

SdoAbort check_pdo_write(const ObjectDictionary& objects, const DriveSettings& settings, ObjectKey key,
                         std::int64_t value) {
  if (is_map(key.index)) {
    return check_map(objects, settings, key, value);
  }
  const DrivePdo pdo(objects, key.index);
  if (key.sub == 1) {
    return check_id(pdo, settings, key, value);
  }
  if (key.sub == 2) {
    return value > 240 && value < 254 ? SdoAbort::ValueRange : SdoAbort::None;
  }
  return key.sub == 3 && pdo.is_valid() ? SdoAbort::WrongState : SdoAbort::None;
}

}  // namespace slamsensor::tools
