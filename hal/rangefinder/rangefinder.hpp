#pragma once

#include "hal/counters.hpp"
#include "hal/device.hpp"
#include "hal/fixed_text.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::hal {

/// What every rangefinder driver counts.
enum class RangeEvent : std::uint8_t {
  ReadingsDropped,   ///< nobody took them
  ReadingsWithheld,  ///< good, but not yet to be trusted: while starting, before lock, before the phase is
                     ///< known
  RecordsRefused,    ///< whole, but not what a reading of this device looks like
  ChecksumErrors,
  LengthsRefused,  ///< a header with a length that no record has
  BytesSkipped,    ///< that belong to no record
  ForeignRecords,  ///< whole and sound, but not asked for
  LocksLost,
  RequestsRepeated,
  RequestsRefused,  ///< the device refused what it was asked to do
  LineRatesTried,
  StreamSilences,
  RateDeviations,  ///< readings came at another rate than was set
  TimingDoubts,    ///< times since which readings could not be timed: see Device::timing_doubt()
  PeriodsMissing,  ///< readings that never came, as gaps between arrivals show
  PhaseLocks,      ///< pauses after which the times of readings were found anew
  StartsOver,
  LinkLosses,
};
inline constexpr std::size_t kRangeEvents = static_cast<std::size_t>(RangeEvent::LinkLosses) + 1;

class RangeCounters : public EventCounters<RangeEvent, kRangeEvents> {
 public:
  RangeCounters() noexcept
      : EventCounters(std::array<std::string_view, kRangeEvents>{
            "readings_dropped", "readings_withheld", "records_refused", "checksum_errors", "lengths_refused",
            "bytes_skipped", "foreign_records", "locks_lost", "requests_repeated", "requests_refused",
            "line_rates_tried", "stream_silences", "rate_deviations", "timing_doubts", "periods_missing",
            "phase_locks", "starts_over", "link_losses"}) {}
};

/// What came back of one shot.
enum class Echo : std::uint8_t {
  Return,     ///< a distance
  None,       ///< nothing within range: open sky
  Weak,       ///< something, too faint to be trusted
  Saturated,  ///< something, too bright to be measured
  Fault,      ///< the device says that it did not measure
};

struct RangeSample {
  /// When the device began to send the reading, from arrival, line rate and the device's own period. It
  /// measured a constant time earlier, which is unknown here (firmware/scan finds it).
  Stamp stamp{};
  double range_m = 0.0;   ///< meaningful for Echo::Return alone, and then positive; 0 otherwise
  double strength = 0.0;  ///< in the device's unit; 0 when it reports none
  Echo echo = Echo::None;
  /// The distance that the device told, whatever came back: a device that always tells the same is stuck.
  double told_m = 0.0;
};

struct RangefinderInfo {
  FixedText<32> product;
  double rate_hz = 0.0;  ///< readings per second that were asked for and confirmed
  double range_max_m = 0.0;
};

class Rangefinder : public Device {
 public:
  /// Moves the oldest readings into `into`, in the order of time, and returns how many. Those nobody takes
  /// are dropped, oldest kept, and counted ("readings_dropped").
  [[nodiscard]] virtual std::size_t take(std::span<RangeSample> into) noexcept = 0;

  /// What the device said of itself; valid while Ready.
  [[nodiscard]] virtual const RangefinderInfo& info() const noexcept = 0;
};

/// Readings a driver keeps for its caller: 0.2 s at 20 kHz.
inline constexpr std::size_t kRangeSamplesMax = 4096;

}  // namespace slamsensor::hal
