#pragma once

#include "hal/rangefinder/dialogue.hpp"
#include "hal/rangefinder/lwnx_driver.hpp"
#include "hal/rangefinder/lwnx_packet.hpp"
#include "hal/rangefinder/lwnx_products.hpp"
#include "hal/rangefinder/lwnx_reading.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamsensor::hal {

/// The start-up of an LWNX device: find it, know it by its name, then make it send what the configuration
/// asks for with the commands of its row of the table (LW20 serial manual).
class LwnxScript {
 public:
  enum class Step : unsigned {
    Wake,
    Name,
    Quiet,
    Baud,
    BaudToken,
    Save,
    ResetToken,
    Reset,
    Reopen,
    RawMode,
    Rate,
    Output,
    LostSignal,
    Laser,
    Stream,
    Readings,
    Done
  };
  enum class Verdict : std::uint8_t { Answered, Refused, Foreign };

  explicit LwnxScript(const LwnxConfig& config) noexcept : config_(config) {}

  /// What was known of the device is no longer.
  void begin() noexcept { product_ = nullptr; }

  /// See Script::compose. `baud` is the line rate in use; at Step::Reopen the caller has to go to the
  /// configured one.
  [[nodiscard]] StepKind compose(Step step, std::uint32_t baud, Request& into) noexcept;

  /// Takes the device's name and settles how it is used; what stands in the way, if anything, and then the
  /// device counts as not known.
  [[nodiscard]] std::string_view meet(std::string_view name, std::uint32_t baud) noexcept;

  /// Whether what stands in the way is the line rate, not the device.
  [[nodiscard]] static bool is_of_rate(std::string_view trouble) noexcept;

  /// What a packet says of the request under way (but the name).
  [[nodiscard]] Verdict judge(const LwnxPacket& packet) noexcept;

  /// What follows is valid while the device is known.
  [[nodiscard]] bool knows_device() const noexcept { return product_ != nullptr; }
  [[nodiscard]] const LwnxLayout& layout() const noexcept { return layout_; }
  [[nodiscard]] double rate_hz() const noexcept { return rate_hz_; }
  [[nodiscard]] std::size_t readings_per_packet() const noexcept { return is_raw() ? kRawBlock : 1; }
  [[nodiscard]] const LwnxProduct& product() const noexcept { return *product_; }
  /// The command under which readings come.
  [[nodiscard]] std::uint8_t reading_id() const noexcept;
  [[nodiscard]] bool is_raw() const noexcept { return config_.mode == LwnxMode::RawReadings; }

 private:
  static constexpr std::size_t kRawBlock = 200;

  StepKind read(Request& into, std::uint8_t id) noexcept;
  StepKind write(Request& into, std::uint8_t id, std::uint32_t value, std::size_t width) noexcept;
  StepKind compose_baud(Step step, std::uint32_t baud, Request& into) noexcept;
  StepKind compose_settings(Step step, Request& into) noexcept;
  [[nodiscard]] std::string_view plan(std::uint32_t baud) noexcept;
  [[nodiscard]] bool changes_baud(std::uint32_t baud) const noexcept;

  LwnxConfig config_;
  const LwnxProduct* product_ = nullptr;
  LwnxLayout layout_;
  LwnxRate rate_;
  double rate_hz_ = 1.0;
  std::uint8_t asked_id_ = 0;
  std::array<std::uint8_t, 4> asked_value_{};
  std::size_t asked_width_ = 0;  ///< 0: any answer will do
  std::uint16_t token_ = 0;
  bool baud_was_changed_ = false;
};

}  // namespace slamsensor::hal
