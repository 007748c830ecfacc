#pragma once

#include "hal/counters.hpp"

#include <array>
#include <cstdint>
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
  RequestsRefused,  ///< the device answered otherwise than it was told
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

class RangeCounters : public Counters<RangeEvent, kRangeEvents> {
 public:
  RangeCounters() noexcept
      : Counters(std::array<std::string_view, kRangeEvents>{
            "readings_dropped", "readings_withheld", "records_refused", "checksum_errors", "lengths_refused",
            "bytes_skipped", "foreign_records", "locks_lost", "requests_repeated", "requests_refused",
            "line_rates_tried", "stream_silences", "rate_deviations", "timing_doubts", "periods_missing",
            "phase_locks", "starts_over", "link_losses"}) {}
};

}  // namespace slamsensor::hal
