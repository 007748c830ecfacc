#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/output/nmea.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/status/sensor_status.hpp"
#include "hal/counters.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <poll.h>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

/// Whether there is something to say that no epoch has said yet.
enum class EpochNews : std::uint8_t { None, Waiting };

enum class EpochKind : std::uint8_t { Regular, Prompt };

struct PlannedEpoch {
  std::chrono::nanoseconds utc{0};  ///< what its sentences are stamped with: a whole number of 0.01 s
  EpochKind kind = EpochKind::Regular;
  bool begins_second = false;  ///< the first regular epoch of its second
  std::uint64_t missed = 0;    ///< regular epochs before it that nobody asked for in time
};

/// When an epoch is to be written, and its time stamp.
///
/// A scan takes seconds to minutes, and readers of NMEA expect a steady rate. So regular epochs come at the
/// whole multiples of the period in UTC (of a rate in whole thousandths of a hertz, counted from a whole
/// thousand seconds: every second, tenth of a second, ten seconds), whether or not there is something new.
/// News also get a prompt epoch of their own at once, at most one in the shorter of a period and a second;
/// within 10 ms before a regular epoch they wait for it. From a prompt epoch to a regular one, and back,
/// stamps rise by at least 0.02 s (see kStampGap), unless the system's clock is set back. They always rise:
/// gpsd takes two GGA of one time for a receiver that is stuck.
///
/// No clock, nothing allocated; one thread.
class EpochPlanner {
 public:
  /// `rate_hz` within 0.1 .. 10; one outside is brought to its end.
  explicit EpochPlanner(double rate_hz) noexcept { set_rate(rate_hz); }

  /// Regular epochs follow the new rate from its next multiple on.
  void set_rate(double rate_hz) noexcept;

  /// The epoch that is to be written now, if one is. A regular one takes the news along. Of several regular
  /// ones that were missed only the last is given. The first call only begins the count.
  [[nodiscard]] std::optional<PlannedEpoch> next(const OutputTime& now, EpochNews news) noexcept;

  /// How long until next() may have an epoch; at most a period.
  [[nodiscard]] hal::Stamp wait(const OutputTime& now, EpochNews news) const noexcept;

  /// How often the system's clock was found to have been set, by half a second or more.
  [[nodiscard]] std::uint64_t clock_steps() const noexcept { return clock_steps_; }

 private:
  using Hundredths = std::chrono::duration<std::int64_t, std::centi>;

  [[nodiscard]] std::int64_t index_at(std::chrono::nanoseconds utc) const noexcept;
  [[nodiscard]] std::chrono::nanoseconds time_of(std::int64_t index) const noexcept;
  [[nodiscard]] hal::Stamp prompt_gap() const noexcept;
  [[nodiscard]] bool was_clock_set(const OutputTime& now) const noexcept;
  [[nodiscard]] std::optional<PlannedEpoch> regular(std::int64_t index) noexcept;
  [[nodiscard]] std::optional<PlannedEpoch> prompt(const OutputTime& now) noexcept;

  std::int64_t rate_mhz_ = 1000;
  std::optional<OutputTime> last_call_;
  std::int64_t last_index_ = 0;  ///< of the last regular epoch, or of the start
  std::optional<Hundredths> last_stamp_;
  std::optional<hal::Stamp> last_prompt_;
  std::optional<std::chrono::seconds> last_second_;
  std::uint64_t clock_steps_ = 0;
};

struct NmeaPublisherConfig {
  NmeaConfig nmea;
  double rate_hz = 1.0;  ///< [0.1, 10] regular epochs per second
  std::optional<Datum> datum;
};

/// The fix that an epoch at `now` shows: that of `status`, but no fix when the sensor does not stand as
/// the fix says (a position is shown in the state Fixed alone), or when the report is older than 5 s, because
/// nobody is there any more to withdraw it.
[[nodiscard]] core::Fix shown_fix(const SensorStatus& status, hal::Stamp now) noexcept;

enum class NmeaEvent : std::uint8_t {
  Epochs,      ///< written, regular and prompt
  Prompt,      ///< of them, those at once for the answer of a scan
  Missed,      ///< regular epochs that were left out because step() came too late
  ClockSteps,  ///< the system's clock was set while running
};

/// Writes the sensor's NMEA 0183 stream into its sinks (DESIGN 4).
///
/// Every epoch shows how the sensor stands at that moment. Between two scans that is the place of the last
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

  /// How long until step() has something to do that no poll_on() waits for; at most 100 ms.
  [[nodiscard]] hal::Stamp wait(const OutputTime& now) const noexcept;

  /// As EpochSink::poll_on, of all sinks.
  [[nodiscard]] std::size_t poll_on(std::span<pollfd> into) const noexcept;

  /// Of the publisher and of all its sinks.
  void append_counters(CounterTable& table) const noexcept;

  /// The first problem of a sink; empty when there is none.
  [[nodiscard]] std::string_view problem() const noexcept;

 private:
  [[nodiscard]] std::span<EpochSink* const> sinks() const noexcept { return {sinks_.data(), sink_count_}; }
  void write(const core::Fix& shown, const PlannedEpoch& epoch, const OutputTime& now) noexcept;

  NmeaPublisherConfig config_;
  std::optional<GeoReference> geo_;
  EpochPlanner planner_;
  std::array<EpochSink*, kSinksMax> sinks_{};
  std::size_t sink_count_ = 0;
  EpochNews news_ = EpochNews::None;
  NmeaMode mode_ = NmeaMode::Live;
  core::FixStatus last_status_ = core::FixStatus::NoFix;  ///< that an epoch showed
  hal::Stamp last_scan_{};                                ///< end of the scan that an epoch showed
  std::array<char, kNmeaEpochBytesMax> bytes_{};
  hal::EventCounters<NmeaEvent, 4> counters_;
};

}  // namespace slamsensor::firmware
