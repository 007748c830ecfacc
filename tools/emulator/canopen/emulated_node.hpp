#pragma once

#include "hal/transport/can_link.hpp"
#include "tools/emulator/fault.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// Why an SDO transfer is aborted (CiA 301, SDO abort codes).
enum class SdoAbort : std::uint32_t {
  None = 0,
  Toggle = 0x0503'0000,
  BadCommand = 0x0504'0001,
  UnsupportedAccess = 0x0601'0000,
  WriteOnly = 0x0601'0001,
  ReadOnly = 0x0601'0002,
  NoObject = 0x0602'0000,
  NotMappable = 0x0604'0041,
  MappingTooLong = 0x0604'0042,
  TooLong = 0x0607'0012,
  TooShort = 0x0607'0013,
  NoSubIndex = 0x0609'0011,
  ValueRange = 0x0609'0030,
  ValueTooHigh = 0x0609'0031,
  ValueTooLow = 0x0609'0032,
  MaxBelowMin = 0x0609'0036,
  General = 0x0800'0000,
  WrongState = 0x0800'0022,
  NoData = 0x0800'0024,
};

/// An object's name: index and sub-index.
struct ObjectKey {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  auto operator<=>(const ObjectKey&) const = default;
};

enum class ObjectType : std::uint8_t { U8, I8, U16, I16, U32, I32, Text };
enum class ObjectAccess : std::uint8_t { ReadOnly, WriteOnly, ReadWrite };
enum class ObjectMapping : std::uint8_t { None, Transmit, Receive, Both };

/// An entry of the dictionary; `value` as a number, sign included.
struct CanObject {
  ObjectType type = ObjectType::U32;
  ObjectAccess access = ObjectAccess::ReadOnly;
  std::int64_t value = 0;
  ObjectMapping mapping = ObjectMapping::None;
  std::int64_t low = INT64_MIN;  ///< what a host may write
  std::int64_t high = INT64_MAX;
  std::string text{};
};

/// Bytes of a number of `type`; 0 for a Text.
[[nodiscard]] std::uint8_t width_of(ObjectType type) noexcept;

/// The number in `bytes`, least significant first, signed where `type` is.
[[nodiscard]] std::int64_t number_from(ObjectType type, std::span<const std::uint8_t> bytes) noexcept;

/// Appends the lowest `width` bytes of `value`, least significant first.
void append_number(std::vector<std::uint8_t>& bytes, std::int64_t value, std::uint8_t width);

/// A node's objects. It knows what may be written in general; what a value means is the node's business.
class ObjectDictionary {
 public:
  void add(ObjectKey key, const CanObject& object) { objects_[key] = object; }

  /// Null when there is none.
  [[nodiscard]] const CanObject* find(ObjectKey key) const;

  /// Why there is no such object: neither it nor any of its index, or no such sub-index.
  [[nodiscard]] SdoAbort missing(ObjectKey key) const;

  /// Bytes of the number `key`; 0 when there is none.
  [[nodiscard]] std::size_t width(ObjectKey key) const {
    return find(key) == nullptr ? 0 : width_of(find(key)->type);
  }

  /// Of an object that is there.
  [[nodiscard]] std::int64_t value(ObjectKey key) const { return objects_.at(key).value; }
  void set(ObjectKey key, std::int64_t value) { objects_.at(key).value = value; }

  /// Whether a host may write `bytes`: it exists, is writable, has this length, and takes this value.
  [[nodiscard]] SdoAbort check_write(ObjectKey key, std::span<const std::uint8_t> bytes) const;

  /// All objects with an index in [first, last] are as in `defaults`.
  void restore(const ObjectDictionary& defaults, std::uint16_t first, std::uint16_t last);

 private:
  std::map<ObjectKey, CanObject> objects_;
};

/// Who knows a node's objects.
class ObjectKeeper {
 public:
  ObjectKeeper() = default;
  ObjectKeeper(const ObjectKeeper&) = delete;
  ObjectKeeper& operator=(const ObjectKeeper&) = delete;
  virtual ~ObjectKeeper() = default;

  /// Appends what the object holds to `bytes`, or says why not.
  [[nodiscard]] virtual SdoAbort read_object(ObjectKey key, std::vector<std::uint8_t>& bytes) = 0;

  /// Writes the object, or says why not.
  [[nodiscard]] virtual SdoAbort write_object(ObjectKey key, std::span<const std::uint8_t> bytes) = 0;

  /// Bytes of a number, 0 when there is none such.
  [[nodiscard]] virtual std::size_t object_width(ObjectKey key) const = 0;
};

using SdoBytes = std::array<std::uint8_t, 8>;

/// The default SDO server of a node (CiA 301): expedited transfers and segmented ones; no block transfers.
class SdoServer {
 public:
  explicit SdoServer(ObjectKeeper& keeper) : keeper_(keeper) {}

  /// The answer to `request`; nothing to an abort, or when none is to come.
  [[nodiscard]] std::optional<SdoBytes> answer(const SdoBytes& request);

  /// The next request is refused (SdoAbort) or not answered (SdoSilence); false for other faults.
  bool order(FaultKind kind);

  /// Forgets the transfer under way.
  void reset() { transfer_ = Transfer::None; }

 private:
  [[nodiscard]] std::optional<SdoBytes> serve(const SdoBytes& request);
  [[nodiscard]] SdoBytes abort(const SdoBytes& request, SdoAbort code);

  enum class Transfer : std::uint8_t { None, Upload, Download };

  [[nodiscard]] SdoBytes begin_download(const SdoBytes& request);
  [[nodiscard]] SdoBytes download_segment(const SdoBytes& request);
  [[nodiscard]] SdoBytes begin_upload(const SdoBytes& request);
  [[nodiscard]] SdoBytes upload_segment(const SdoBytes& request);
  [[nodiscard]] SdoBytes give_up(SdoAbort code);

  ObjectKeeper& keeper_;
  Transfer transfer_ = Transfer::None;
  ObjectKey key_;                    // of the transfer
  std::vector<std::uint8_t> bytes_;  // of it
  std::size_t sent_ = 0;             // of an upload
  std::uint8_t toggle_ = 0;          // of the next segment
  unsigned aborts_ = 0;              // ordered
  unsigned silences_ = 0;
};

/// A data frame of a node.
[[nodiscard]] hal::CanFrame node_frame(std::uint32_t id, std::span<const std::uint8_t> bytes) noexcept;

/// The data of an emergency message (CiA 301).
[[nodiscard]] std::vector<std::uint8_t> emergency_bytes(std::uint16_t code, std::uint8_t error_register);

}  // namespace slamsensor::tools
