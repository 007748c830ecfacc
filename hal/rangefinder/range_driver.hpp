#pragma once

#include "hal/fixed_text.hpp"
#include "hal/init_error.hpp"
#include "hal/rangefinder/dialogue.hpp"
#include "hal/rangefinder/rangefinder.hpp"
#include "hal/ring.hpp"
#include "hal/timing/sample_clock.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

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

/// Settings that every rangefinder driver has.
struct RangeConfig {
  double range_max_m = 300.0;  ///< what is farther is Echo::None; positive
  double weak_below = 0.0;     ///< strength, in the device's unit, below which a distance is not trusted
  double saturated_from = std::numeric_limits<double>::infinity();  ///< strength from which it is not
  SampleClockConfig clock{};
};

/// What is wrong with `config`, if anything.
[[nodiscard]] std::optional<InitError> range_config_error(const RangeConfig& config);

/// A reading as its record holds it.
struct Measurement {
  double range_m = 0.0;
  double strength = 0.0;
  Echo echo = Echo::Return;
  double told_m = 0.0;  ///< see RangeSample; set by judged()
};

enum class Strength : std::uint8_t { Unknown, Known };

/// `raw` with what no driver may hand out taken away: a distance that is not finite is a fault; one that is
/// not positive or beyond the range is no return; one of a known strength outside the limits is Weak or
/// Saturated.
[[nodiscard]] Measurement judged(Measurement raw, Strength strength, const RangeConfig& config) noexcept;

/// What is common to all rangefinder drivers: the readings kept for the caller, their times, the state.
class RangeDriver : public Rangefinder, protected Script {
 public:
  void step(Stamp now) noexcept final;
  [[nodiscard]] DeviceState state() const noexcept final { return dialogue_.state(); }
  [[nodiscard]] std::string_view problem() const noexcept final;
  [[nodiscard]] std::string_view timing_doubt() const noexcept final { return doubt_.view(); }
  [[nodiscard]] std::span<const Counter> counters() const noexcept final { return counters_.all(); }
  [[nodiscard]] std::size_t take(std::span<RangeSample> into) noexcept final { return samples_.take(into); }
  [[nodiscard]] const RangefinderInfo& info() const noexcept final { return info_; }

 protected:
  static constexpr std::size_t kBlockMax = 256;
  static constexpr std::size_t kDoubtMax = 95;  ///< an LCM status has room for no more

  RangeDriver(std::unique_ptr<DeviceLine> line, const RangeConfig& config) noexcept;

  /// Reads what has arrived, at most a step's share, and acts on it.
  virtual void receive(Stamp now) noexcept = 0;

  /// Hands out readings (at most kBlockMax) of which the last cannot have been sent later than `latest`;
  /// withholds them while the driver is not Ready or the clock not settled.
  void deliver(std::span<const Measurement> block, Stamp latest, Stamp now) noexcept;

  /// From here on the device sends `rate_hz`, in records of `block` readings.
  void expect_rate(double rate_hz, std::size_t block) noexcept;

  [[nodiscard]] const RangeConfig& config() const noexcept { return config_; }
  RangeCounters counters_;
  RangefinderInfo info_;
  SampleClock clock_;
  std::unique_ptr<DeviceLine> line_;
  Dialogue dialogue_;

 private:
  void tell_doubt() noexcept;
  void tell_unframed() noexcept;
  void forget_unframed() noexcept;

  RangeConfig config_;
  bool was_in_doubt_ = false;
  double reported_hz_ = 0.0;
  FixedText<kDoubtMax> doubt_;
  std::uint64_t skipped_before_ = 0;  ///< of the counters, when a reading came last
  std::uint64_t checksums_before_ = 0;
  std::uint64_t told_unframed_ = 0;
  FixedText<kRemarkMax> unframed_;  ///< bytes come, but no reading
  Ring<RangeSample, kRangeSamplesMax> samples_;
};

/// A driver on a serial line: bytes to records, and the time and the loss that the place of a record in the
/// stream shows.
class SerialRangeDriver : public RangeDriver {
 protected:
  SerialRangeDriver(ByteLink& link, const LineRates& rates, const RangeConfig& config) noexcept;

  void receive(Stamp now) noexcept final;

  static constexpr Stamp kPause = std::chrono::milliseconds(50);  ///< longer than any lump of the host

  /// Acts on the next byte of the stream.
  virtual void on_byte(std::uint8_t byte, Stamp now) noexcept = 0;
  /// No byte has come for kPause: no record is under way.
  virtual void on_pause(Stamp now) noexcept = 0;

  /// deliver() for the record in the bytes [begin, end) of the stream.
  void deliver_record(std::span<const Measurement> block, std::uint64_t begin, std::uint64_t end,
                      Stamp now) noexcept;

  SerialDeviceLine& serial_;

 private:
  std::uint64_t last_end_ = 0;  ///< of the last record delivered; 0: none since the clock started
  Stamp last_byte_{};
};

}  // namespace slamsensor::hal
