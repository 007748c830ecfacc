#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tools {

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
  Closest,   ///< of the last five
  Median,    ///< of the last five
  Furthest,  ///< of the last five
  Strength,  ///< per cent
  Noise,
  Temperature,  ///< 1/100 degC
  Yaw,          ///< 1/100 deg; the motor is idle
  Alarm,
};

/// What streams under a value of the stream command.
enum class LwnxStream : std::uint8_t {
  Off,
  Raw,      ///< ID 40, many readings in a packet
  Cm,       ///< ID 44
  Mm,       ///< ID 45
  Ignored,  ///< a histogram or waveform, which is not emulated
};

/// IDs of the commands whose number differs from product to product; 255 where a product has none.
struct LwnxIds {
  std::uint8_t distance_output = 27;
  std::uint8_t temperature = 57;
  std::uint8_t update_rate = 66;
  std::uint8_t high_speed = 255;
  std::uint8_t noise = 74;
  std::uint8_t zero_offset = 75;
  std::uint8_t lost_counter = 76;
  std::uint8_t baud = 79;
};

/// How ASCII answers look: "ldf,0:12.34" or "?LD 12.34".
enum class LwnxTextStyle : std::uint8_t { Sf20, Sf11 };

/// A LightWare product as its manual, LightWare's samples and the public drivers describe it.
struct LwnxProduct {
  std::string name;       ///< answer to command 0
  std::string text_name;  ///< in ASCII answers
  LwnxIds ids;
  std::vector<LwnxRegister> registers;
  std::vector<LwnxField> fields;    ///< bit 0 first
  std::uint8_t cm_field_bytes = 2;  ///< of a field in ID 44
  double cm_units_per_m = 100.0;    ///< of distances in ID 44
  std::uint8_t mm_signals = 0;      ///< ID 45: pairs of distance and strength; 0: the fields, 4 bytes each
  std::vector<std::pair<std::uint32_t, LwnxStream>> streams;
  std::vector<double> rates_hz;        ///< of the values of update_rate; empty: the value is Hz x 10
  std::uint32_t first_rate_value = 1;  ///< that stands for rates_hz.front()
  std::uint32_t lost_counter_min = 0;
  double zero_offset_unit_m = 0.001;
  std::uint32_t baud = 115200;          ///< from the factory
  std::uint8_t unanswered_first = 0;    ///< serial commands after power-up that choose the interface
  std::uint8_t unanswered_packets = 0;  ///< packets after that which only switch LWNX on
  LwnxTextStyle text_style = LwnxTextStyle::Sf20;
  std::int64_t no_return = -1;      ///< distance word of ID 40 and 44 when nothing came back
  std::int64_t no_return_mm = -10;  ///< the same of ID 45

  [[nodiscard]] const LwnxRegister* find(std::uint8_t id) const;
  [[nodiscard]] LwnxRegister* find(std::uint8_t id);

  /// What `value` of the stream command switches on; nothing when the product does not know it.
  [[nodiscard]] std::optional<LwnxStream> stream(std::uint32_t value) const;

  /// Readings per second under `value` of the update rate; nothing when it is no value of it.
  [[nodiscard]] std::optional<double> rate_hz(std::uint64_t value) const;
};

/// The product as it leaves the factory. Every part may be changed before an emulator is made of it.
[[nodiscard]] LwnxProduct lwnx_product(LwnxModel model);

/// Line rates of the values 0 to 7 of the baud command.
[[nodiscard]] std::optional<std::uint32_t> lwnx_baud(std::uint64_t value);

/// The value that stands for `baud`; nothing when none does.
[[nodiscard]] std::optional<std::uint8_t> lwnx_baud_value(std::uint32_t baud);

}  // namespace slamsensor::tools
