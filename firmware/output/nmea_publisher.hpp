#pragma once

#include "firmware/config/config.hpp"
#include "firmware/output/epoch_planner.hpp"
#include "firmware/output/geo_reference.hpp"
#include "firmware/output/nmea.hpp"
#include "firmware/output/output_time.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/status/sensor_status.hpp"
#include "hal/counters.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <poll.h>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

struct NmeaPublisherConfig {
  NmeaConfig nmea;
  double rate_hz = 1.0;  ///< [0.1, 10] regular epochs per second
  std::optional<Datum> datum;
};

/// The fix that an epoch at `now` tells of: that of `status`, but no fix when the sensor does not stand as
/// the fix says (a position is told in the state Fixed alone), or when the report is older than 5 s, because
/// nobody is there any more to withdraw it.
[[nodiscard]] core::Fix told_fix(const SensorStatus& status, hal::Stamp now) noexcept;

enum class NmeaEvent : std::uint8_t {
  Epochs,      ///< written, regular and prompt
  Prompt,      ///< of them, those at once for the answer of a scan
  Missed,      ///< regular epochs that were left out because step() came too late
  ClockSteps,  ///< the system's clock was set while running
};

/// Writes the sensor's NMEA 0183 stream into its sinks (DESIGN 4).
///
/// Every epoch tells how the sensor stands at that moment. Between two scans that is the place of the last
/// fix, with the epoch's own time in every sentence, for that is where the sensor was found to be; how old
/// the scan is stands in the last field of PSLMA. As soon as the fix is stale, withdrawn by a scan without
/// one, or the devices are lost or held, the next epoch says that there is none. The answer of a scan, and
/// the loss of a fix, also make an epoch of their own at once (NmeaConfig::prompt; EpochPlanner).
///
/// step() allocates nothing and never waits. One thread.
class NmeaPublisher {
 public:
  static constexpr std::size_t kSinksMax = 4;

  explicit NmeaPublisher(const NmeaPublisherConfig& config);
  NmeaPublisher(const NmeaPublisher&) = delete;
  NmeaPublisher& operator=(const NmeaPublisher&) = delete;

  /// What follows is written with these settings.
  void set_config(const NmeaPublisherConfig& config);

  /// From now on `sink` receives every epoch and is stepped, until it is taken out; false when there are
  /// kSinksMax already. A recording is a sink like any other.
  [[nodiscard]] bool add(EpochSink& sink) noexcept;
  void take_out(const EpochSink& sink) noexcept;

  /// Steps the sinks and writes the epoch that is due, if one is. Call it at least every 100 ms, and at once
  /// when there is a new answer of a scan. `now` never decreases on the monotonic clock.
  void step(const OutputTime& now, const SensorStatus& status) noexcept;

  /// How long until step() has something to do that no poll_on() tells of; at most 100 ms.
  [[nodiscard]] hal::Stamp wait(const OutputTime& now) const noexcept;

  /// As EpochSink::poll_on, of all sinks.
  [[nodiscard]] std::size_t poll_on(std::span<pollfd> into) const noexcept;

  /// Of the publisher and of all its sinks.
  void append_counters(CounterTable& table) const noexcept;

  /// The first problem of a sink; empty when there is none.
  [[nodiscard]] std::string_view problem() const noexcept;

 private:
  [[nodiscard]] std::span<EpochSink* const> sinks() const noexcept { return {sinks_.data(), sink_count_}; }
  void write(const core::Fix& told, const PlannedEpoch& epoch, const OutputTime& now) noexcept;

  NmeaPublisherConfig config_;
  std::optional<GeoReference> geo_;
  EpochPlanner planner_;
  std::array<EpochSink*, kSinksMax> sinks_{};
  std::size_t sink_count_ = 0;
  EpochNews news_ = EpochNews::None;
  NmeaMode mode_ = NmeaMode::Live;
  core::FixStatus last_status_ = core::FixStatus::NoFix;  ///< that an epoch told
  hal::Stamp last_scan_{};                                ///< end of the scan that an epoch told of
  std::array<char, kNmeaEpochBytesMax> bytes_{};
  hal::Counters<NmeaEvent, 4> counters_;
};

}  // namespace slamsensor::firmware
