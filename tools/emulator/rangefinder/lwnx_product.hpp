#pragma once

#include "hal/stamp.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tools {

/// CRC-16/XMODEM (polynomial 0x1021, start 0, nothing reflected or inverted): 0x31C3 for "123456789".
[[nodiscard]] constexpr std::uint16_t crc16_xmodem(std::span<const std::uint8_t> bytes) {
  constexpr auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (unsigned high = 0; high < table.size(); ++high) {
      unsigned remainder = high << 8U;
      for (int bit = 0; bit < 8; ++bit) {
        remainder = (remainder << 1U) ^ ((remainder & 0x8000U) != 0U ? 0x1021U : 0U);
      }
      table[high] = static_cast<std::uint16_t>(remainder);
    }
    return table;
  }();
  std::uint16_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    const auto index = static_cast<std::uint8_t>((crc >> 8U) ^ byte);
    crc = static_cast<std::uint16_t>((crc << 8U) ^ kTable[index]);
  }
  return crc;
}

enum class RequestAccess : std::uint8_t { Read, Write };

/// A request of the host that arrived whole.
struct LwnxRequest {
  std::uint8_t id = 0;
  RequestAccess access = RequestAccess::Read;
  std::vector<std::uint8_t> data;
};

/// The packet that carries `data` (at most 1022 bytes) under `id`, in place of what was in `packet`: start,
/// length and access, ID, data, CRC (LW20 serial manual).
void build_packet(std::uint8_t id, RequestAccess access, std::span<const std::uint8_t> data,
                  std::vector<std::uint8_t>& packet);

/// Finds the host's requests between other bytes. A packet that stops for 100 ms is forgotten; after a wrong
/// CRC the search goes on one byte behind the false start.
class LwnxReceiver {
 public:
  /// Takes a byte that arrived at `at`; a request when it completes one.
  [[nodiscard]] std::optional<LwnxRequest> push(std::uint8_t byte, hal::Stamp at);

  /// Whether a packet has begun and is not complete.
  [[nodiscard]] bool in_packet() const { return !buffer_.empty(); }

  void clear() { buffer_.clear(); }

  /// Packets with a wrong CRC or an impossible length.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  [[nodiscard]] std::optional<LwnxRequest> take_request();
  [[nodiscard]] std::size_t packet_bytes() const;
  void skip_false_start();

  std::vector<std::uint8_t> buffer_;
  hal::Stamp last_byte_{};
  std::uint64_t refused_ = 0;
};

/// `value` in `bytes` bytes, least significant first, at the end of `data`.
void append_little_endian(std::int64_t value, std::size_t bytes, std::vector<std::uint8_t>& data);

/// All of `data` as an unsigned number, least significant byte first; at most 8 bytes.
[[nodiscard]] std::uint64_t little_endian(std::span<const std::uint8_t> data);

enum class LwnxModel : std::uint8_t { Lw20, Sf20, Lw24, Sf000, Sf11, Sf30d, Sf45b, Grf500 };

/// What a command reads and writes.
struct LwnxRegister {
  std::uint8_t id = 0;
  std::uint8_t read_bytes = 0;              ///< 0: cannot be read
  std::optional<std::uint8_t> write_bytes;  ///< nothing: cannot be written
  enum class Keeps : std::uint8_t { No, WhenSaved } keeps = Keeps::No;
  std::int64_t initial = 0;  ///< from the factory
};

/// What a bit of the distance output stands for. Only one echo is emulated: the last return is the first.
enum class LwnxField : std::uint8_t {
  Raw,
  Filtered,  ///< closest, median or furthest of the last few: reported as the raw one
  Strength,  ///< per cent
};

/// What streams under a value of the stream command.
enum class LwnxStream : std::uint8_t {
  Off,
  Raw,  ///< ID 40, many readings in a packet
  Cm,   ///< ID 44
  Mm,   ///< ID 45
};

/// IDs of the commands whose number differs from product to product; 255 where a product has none.
struct LwnxIds {
  std::uint8_t distance_output = 27;
  std::uint8_t update_rate = 66;
  std::uint8_t high_speed = 255;
  std::uint8_t lost_counter = 76;
  std::uint8_t baud = 79;
};

/// What a driver meets of a LightWare product, as its manual, LightWare's samples and the public drivers
/// describe it.
struct LightWareProduct {
  std::string name;  ///< answer to command 0
  LwnxIds ids;
  std::vector<LwnxRegister> registers;
  std::vector<LwnxField> fields;    ///< bit 0 first
  std::uint8_t cm_field_bytes = 2;  ///< of a field in ID 44
  double cm_units_per_m = 100.0;    ///< of distances in ID 44
  std::vector<std::pair<std::uint32_t, LwnxStream>> streams;
  std::vector<double> rates_hz;        ///< of the values of update_rate; empty: the value is Hz x 10
  std::uint32_t first_rate_value = 1;  ///< that stands for rates_hz.front()
  std::uint32_t lost_counter_min = 0;
  std::uint32_t baud = 115200;          ///< from the factory
  std::uint8_t unanswered_first = 0;    ///< serial commands after power-up that choose the interface
  std::uint8_t unanswered_packets = 0;  ///< packets after that which only switch LWNX on
  std::int64_t no_return = -1;          ///< distance word of ID 40 and 44 when nothing came back
  std::int64_t no_return_mm = -10;      ///< the same of ID 45

  [[nodiscard]] const LwnxRegister* find(std::uint8_t id) const;
  [[nodiscard]] LwnxRegister* find(std::uint8_t id);

  /// What `value` of the stream command switches on; nothing when the product does not know it.
  [[nodiscard]] std::optional<LwnxStream> stream(std::uint32_t value) const;

  /// Readings per second under `value` of the update rate; nothing when it is no value of it.
  [[nodiscard]] std::optional<double> rate_hz(std::uint64_t value) const;
};

/// The product as it leaves the factory. Every part may be changed before an emulator is made of it.
[[nodiscard]] LightWareProduct lwnx_product(LwnxModel model);

/// Line rates of the values 0 to 7 of the baud command.
[[nodiscard]] std::optional<std::uint32_t> lwnx_baud(std::uint64_t value);

/// The value that stands for `baud`; nothing when none does.
[[nodiscard]] std::optional<std::uint8_t> lwnx_baud_value(std::uint32_t baud);

/// The settings of a LightWare device: what they are now, and what they will be after the next start.
class LwnxRegisters {
 public:
  /// The factory's values of `product`, which outlives this.
  explicit LwnxRegisters(const LightWareProduct& product);

  /// The bytes that a read of `id` returns; empty when it cannot be read.
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::uint8_t id) const;

  /// The same as a number; 0 for a command the product does not have.
  [[nodiscard]] std::uint64_t value(std::uint8_t id) const;

  void set(std::uint8_t id, std::span<const std::uint8_t> bytes);
  void set(std::uint8_t id, std::uint64_t value);

  /// `text` cut to the width of `id`, zeros behind it.
  void set_text(std::uint8_t id, std::string_view text);

  /// Keeps the values that the product keeps.
  void save();

  /// `id` alone is kept as it is.
  void save(std::uint8_t id);

  /// The values after a start: the saved ones, the factory's where nothing is kept.
  void restore() { now_ = saved_; }

  /// The present values are the factory's: for a device that was set up before it was switched on.
  void save_all() { saved_ = now_; }

 private:
  using Values = std::array<std::vector<std::uint8_t>, 256>;

  const LightWareProduct& product_;
  Values now_;
  Values saved_;
};

}  // namespace slamsensor::tools
