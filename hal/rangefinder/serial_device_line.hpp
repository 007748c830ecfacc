#pragma once

#include "hal/rangefinder/device_line.hpp"
#include "hal/timing/arrival_log.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::hal {

/// Line rates at which a device may be found, bit/s, the likeliest first; unused ones are 0.
using LineRates = std::array<std::uint32_t, 9>;

/// `first`, then `others` (as many as there is room for) without it.
[[nodiscard]] LineRates rates_from(std::uint32_t first, std::span<const std::uint32_t> others) noexcept;

/// A serial line whose device may be at another rate than expected, and which knows when bytes arrived.
class SerialDeviceLine final : public DeviceLine {
 public:
  SerialDeviceLine(ByteLink& link, const LineRates& rates) noexcept;

  void service(Stamp now) noexcept override;
  [[nodiscard]] bool is_up() const noexcept override { return link_.is_up(); }
  [[nodiscard]] std::string_view problem() const noexcept override { return link_.problem(); }
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return link_.epoch(); }
  [[nodiscard]] LinkStatus send(std::span<const std::uint8_t> bytes) noexcept override {
    return link_.write(bytes);
  }
  void next_rate() noexcept override;
  void keep_rate() noexcept override { kept_ = rate_; }

  /// Takes bytes that have arrived, at most a step's share; empty when there are none or the share is used
  /// up. The bytes live until the next read.
  [[nodiscard]] std::span<const std::uint8_t> read() noexcept;
  /// Allows the next step's share.
  void allow_bytes() noexcept { read_in_step_ = 0; }

  /// Place in the stream of the byte after those read so far.
  [[nodiscard]] std::uint64_t position() const noexcept { return log_.position(); }

  /// See ArrivalLog::latest_begin.
  [[nodiscard]] Stamp latest_begin(std::uint64_t begin, std::uint64_t end) const noexcept {
    return log_.latest_begin(begin, end, baud());
  }

  /// The line rate in use, or that will be.
  [[nodiscard]] std::uint32_t baud() const noexcept { return rates_[rate_]; }

  /// Goes to `baud`, which joins the rates if it is not one of them.
  void set_baud(std::uint32_t baud) noexcept;

 private:
  static constexpr std::size_t kChunk = 512;
  static constexpr std::size_t kBytesPerStep = 4096;  // 40 ms of the fastest usual line

  void apply_rate() noexcept;
  [[nodiscard]] std::size_t after(std::size_t rate) const noexcept;

  ByteLink& link_;
  LineRates rates_;
  std::size_t rate_ = 0;
  std::size_t other_ = 0;            // the last one tried that was not kept
  std::optional<std::size_t> kept_;  // at which the device was last at work
  std::size_t read_in_step_ = 0;
  ArrivalLog log_;
  std::array<std::uint8_t, kChunk> chunk_{};
};

}  // namespace slamsensor::hal
