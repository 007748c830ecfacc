#pragma once

#include "hal/init_error.hpp"
#include "hal/rangefinder/range_driver.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace slamsensor::hal {

/// How a reading is written on the line.
enum class PointRecord : std::uint8_t {
  AsciiDecimal,  ///< [prefix][sign]digits[.digits][separator strength]terminator
  AsciiHex,      ///< [prefix]hexadecimal digits, terminator
  Packed7,       ///< 7 bits a byte, high bits first; the top bit marks the first byte
};

/// A number, as its digits without the point or its bits, that is no distance.
struct PointCode {
  std::int64_t number = 0;
  Echo echo = Echo::None;
};

/// A text that comes instead of a record, without its terminator.
struct PointText {
  std::string text;
  Echo echo = Echo::Fault;
};

/// A rangefinder that sends records by itself and needs at most to be started.
struct PointLaserConfig {
  std::string product = "point laser";
  /// Whether the layout was found in a manual; if not, problem() says so.
  enum class Layout : std::uint8_t { FromManual, Unverified } layout = Layout::FromManual;
  RangeConfig range;
  double rate_hz = 1000.0;
  std::uint32_t baud = 115200;
  enum class Search : std::uint8_t { ThisBaud, UsualBauds } search = Search::ThisBaud;

  PointRecord record = PointRecord::AsciiDecimal;
  double unit_m = 1.0;  ///< distance = number * unit_m + offset_m
  double offset_m = 0.0;
  std::vector<PointCode> codes;  ///< at most 16
  std::vector<PointText> texts;  ///< ASCII alone; at most 16, each at most 32 characters

  // ASCII.
  std::string terminator = "\r\n";
  std::string prefix;
  enum class Prefix : std::uint8_t { Required, Optional } prefix_is = Prefix::Required;
  /// Characters of a record without its terminator, spaces in front of the number counted. Then a record
  /// from which bytes were lost is never taken for one. With 0, any width, a digit lost by the line gives
  /// another number that looks right: there only `decimals` and the range can give it away.
  std::size_t width = 0;
  int decimals = -1;               ///< digits after the point; -1: any, the point may be missing
  char strength_separator = '\0';  ///< what stands between distance and strength; '\0': no strength

  // Binary.
  std::size_t packed_bytes = 2;  ///< of a Packed7 record: 2 or 3

  // Start and stop; every command with its end of line.
  std::string stop;
  std::vector<std::string> set_up;  ///< at most 8
  std::string start;
  Stamp settle = std::chrono::milliseconds(100);  ///< after each of them
};

/// ASTECH LDS70A (LAM71, LDM71 alike) as its manual says: 115200 baud, decimal output, 1000 readings a
/// second, errors as DE02. Its binary layout and the stop by ESC are not confirmed. The rate (MF / SA) is as
/// stored in the device.
[[nodiscard]] PointLaserConfig astech_lds70a();

/// MDL LaserAce IM HR. UNVERIFIED: no public document gives its serial format; a decimal number in metres
/// ended by CR LF at 1 kHz is a guess to be replaced by the owner's manual. Range 300 m and resolution 0.1 m
/// are from the paper.
[[nodiscard]] PointLaserConfig mdl_laserace_im_hr_unverified();

/// A driver for it; `link` outlives it. An error names the setting, its value and what is allowed.
[[nodiscard]] tl::expected<std::unique_ptr<Rangefinder>, InitError> make_point_laser(
    const PointLaserConfig& config, ByteLink& link);

/// What is wrong with `config`, if anything.
[[nodiscard]] std::optional<InitError> point_laser_config_error(const PointLaserConfig& config);

}  // namespace slamsensor::hal
