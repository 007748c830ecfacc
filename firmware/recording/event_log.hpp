#pragma once

#include "firmware/lcm/message.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// What can be done to the maps between two scans.
enum class MapCommand : std::uint8_t {
  Reset,  ///< forget everything
  Freeze,
  Unfreeze,
  Restore,     ///< go on from a map that was saved
  DropRivals,  ///< go on with the home map alone, as after its Restore; never recorded
};

/// A command to the map while a recording ran, and before which scan that took effect.
struct MapOrder {
  MapCommand kind = MapCommand::Reset;
  std::uint32_t scan = 0;  ///< scans localised before, since the start of the recording
};

/// "reset 12", "freeze 0", "load 3": kind and scan.
[[nodiscard]] std::string text_of(const MapOrder& order);

/// The order that `text` is, or nothing.
[[nodiscard]] std::optional<MapOrder> parse_map_order(std::string_view text) noexcept;

/// `value` is appended, most significant byte first.
template <std::integral T>
void append_big_endian(std::vector<std::uint8_t>& out, T value) {
  for (std::size_t i = sizeof(T); i > 0; --i) {
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * (i - 1))));
  }
}

/// The number in the first sizeof(T) bytes, most significant first; there are that many at least.
template <std::integral T>
[[nodiscard]] T read_big_endian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = (value << 8U) | bytes[i];
  }
  return static_cast<T>(value);
}

/// The event log of LCM 1.3.1 (eventlog.c): per event, most significant byte first, the sync word, the
/// event's number (i64), its time (i64, us), the lengths of channel and data (i32 each), the channel without
/// a NUL, the data.
inline constexpr std::uint32_t kEventSync = 0xEDA1'DA01;
inline constexpr std::size_t kEventHeadBytes = 4 + 8 + 8 + 4 + 4;

/// LCM sends no longer channel names, nor none.
inline constexpr std::size_t kEventChannelMax = 63;

/// Larger events are neither written nor read: a map file is the largest that a recording holds.
inline constexpr std::size_t kEventDataMax = std::size_t{256} << 20;

enum class ExistingFile : std::uint8_t { Refuse, Replace };

/// Writes an LCM event log. The file holds whole events at every moment that the disk allows: what a failed
/// write left of an event is cut off again. After a failure nothing more is written. May wait for the disk.
class EventLogWriter {
 public:
  /// A new, empty log at `path`; the folder exists. The error says what to do.
  [[nodiscard]] static tl::expected<EventLogWriter, hal::InitError> create(const std::filesystem::path& path,
                                                                           ExistingFile existing);

  EventLogWriter(EventLogWriter&& other) noexcept;
  EventLogWriter& operator=(EventLogWriter&&) = delete;
  ~EventLogWriter();

  /// Appends an event at `utime_us`. False when it is not in the log: the channel or the data is too long or
  /// empty, or the log has failed.
  [[nodiscard]] bool write(std::int64_t utime_us, std::string_view channel,
                           std::span<const std::uint8_t> data);

  /// Everything appended is handed to the system; false when the log has failed.
  [[nodiscard]] bool flush();

  /// The same, on the disk, and the file is closed; false when the log has failed, before or now.
  [[nodiscard]] bool close();

  /// Of the file when all is flushed.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return on_file_ + pending_.size(); }
  [[nodiscard]] std::uint64_t events() const noexcept { return events_; }

  /// The system's error number of the failure, 0 before.
  [[nodiscard]] int error() const noexcept { return error_; }

 private:
  explicit EventLogWriter(int fd) noexcept : fd_(fd) {}
  void fail(int error) noexcept;

  int fd_;
  int error_ = 0;
  std::vector<std::uint8_t> pending_;  // whole events
  std::uint64_t on_file_ = 0;
  std::uint64_t events_ = 0;
};

/// Channels of a recording beside those that the sensor transmits on.
inline constexpr std::string_view kConfigChannel = "SLAMSENSOR_CONFIG";  ///< text_t: TOML of all keys
inline constexpr std::string_view kMapChannel = "SLAMSENSOR_MAP_FILE";   ///< block_t 0: the map at the start
inline constexpr std::string_view kTapeChannel = "SLAMSENSOR_TAPE";      ///< block_t: the tape's chunks
inline constexpr std::string_view kOrderChannel = "SLAMSENSOR_ORDER";    ///< text_t: a MapOrder
inline constexpr std::string_view kNmeaChannel = "SLAMSENSOR_NMEA";      ///< text_t: sentences as sent

/// Of the types in block_t.lcm and text_t.lcm.
inline constexpr std::uint64_t kBlockFingerprint =
    lcm_fingerprint({{"utime", "int64_t", ""},
                     {"number", "int64_t", ""},
                     {"checksum", "int32_t", ""},
                     {"size", "int32_t", ""},
                     {"data", "byte", "size", LcmArray::ByMember}});
inline constexpr std::uint64_t kTextFingerprint =
    lcm_fingerprint({{"utime", "int64_t", ""}, {"checksum", "int32_t", ""}, {"text", "string", ""}});

struct Block {
  std::int64_t utime_us = 0;
  std::int64_t number = 0;
  std::span<const std::uint8_t> data;
};

struct Text {
  std::int64_t utime_us = 0;
  std::string_view text;  ///< no NUL in it
};

/// `out` holds exactly the LCM message, fingerprint included. What is to be sent is shorter than 2^31 bytes.
void encode(const Block& block, std::vector<std::uint8_t>& out);
void encode(const Text& text, std::vector<std::uint8_t>& out);

/// What `message` carries, in place; nothing when it is of another type, its lengths do not fit it exactly or
/// its checksum is wrong.
[[nodiscard]] std::optional<Block> decode_block(std::span<const std::uint8_t> message);
[[nodiscard]] std::optional<Text> decode_text(std::span<const std::uint8_t> message);

}  // namespace slamsensor::firmware
