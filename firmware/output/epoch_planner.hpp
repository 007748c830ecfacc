#pragma once

#include "firmware/output/output_time.hpp"

#include <chrono>
#include <cstdint>
#include <optional>

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
/// News also get a prompt epoch of their own at once, at most one in the shorter of a period and a second.
/// Stamps rise by at least 0.01 s from epoch to epoch (gpsd takes two GGA of one time for a receiver that is
/// stuck), unless the system's clock is set back.
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

}  // namespace slamsensor::firmware
