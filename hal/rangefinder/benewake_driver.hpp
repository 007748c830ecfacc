#pragma once

#include "hal/init_error.hpp"
#include "hal/rangefinder/benewake_frame.hpp"
#include "hal/rangefinder/range_driver.hpp"
#include "hal/transport/can_link.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>

namespace slamsensor::hal {

struct BenewakeConfig {
  /// weak_below 0: as the product's manual says (TF03: 40). The TF03's manual calls strength above 1500
  /// highly reflective; set saturated_from where that spoils distances.
  RangeConfig range = {.range_max_m = 180.0};
  BenewakeModel model = BenewakeModel::Tf03;
  double rate_hz = 1000.0;              ///< n times 1, 10, 100 or 1000 with n from 1 to 9, or 10 000
  std::uint16_t over_range_cm = 18000;  ///< the TF03 says this for "nothing"; also set in it
  Stamp reply_patience = std::chrono::seconds(1);
};

struct BenewakeSerialConfig {
  BenewakeConfig device;
  std::uint32_t baud = 115200;  ///< tried first
  /// Whether a device found at another rate is set to `baud` (until its power goes).
  enum class Baud : std::uint8_t { Keep, Change } policy = Baud::Keep;
};

struct BenewakeCanConfig {
  BenewakeConfig device;
  std::uint32_t device_id = 0x003;  ///< of the frames with readings
  bool device_id_is_extended = false;
  std::uint32_t host_id = 0x3003;  ///< of the frames with commands
  bool host_id_is_extended = true;
  std::uint32_t bitrate = 1'000'000;
  /// Whether the device takes the serial commands over CAN: not said by its manual. None: it must already
  /// send at `device.rate_hz`.
  enum class Commands : std::uint8_t { None, AsSerial } commands = Commands::AsSerial;
};

/// Drivers for the TF03 and its relatives; the link outlives them. An error names the setting, its value and
/// what is allowed.
[[nodiscard]] tl::expected<std::unique_ptr<Rangefinder>, InitError> make_benewake_serial(
    const BenewakeSerialConfig& config, ByteLink& link);
[[nodiscard]] tl::expected<std::unique_ptr<Rangefinder>, InitError> make_benewake_can(
    const BenewakeCanConfig& config, CanLink& link);

/// What is wrong with `config`, if anything.
[[nodiscard]] std::optional<InitError> benewake_config_error(const BenewakeConfig& config);

/// `config` with the product's own strength limit where none is set.
[[nodiscard]] BenewakeConfig with_product_limits(BenewakeConfig config) noexcept;

}  // namespace slamsensor::hal
