#pragma once

#include "hal/stamp.hpp"
#include "hal/timing/lower_line.hpp"
#include "hal/timing/rate_check.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::hal {

enum class SampleTiming : std::uint8_t {
  Periodic,   ///< the device sends at a constant rate: its own times are reconstructed
  AsArrived,  ///< it does not: a reading has the latest moment at which it can have been sent
};

struct SampleClockConfig {
  SampleTiming timing = SampleTiming::Periodic;
  double tolerance_ppm = 2000.0;  ///< the device's rate is within this of the nominal one; 0 to 100000
  /// Bytes are handed out by the host in lumps of at most this: a lateness that lasts longer is a gap.
  Stamp lump = std::chrono::milliseconds(20);
  /// After a pause of this the device's phase is taken to be new.
  Stamp stop = std::chrono::milliseconds(300);
};

/// The times at which a device sent its periodic readings, found from arrivals that are late by queues and
/// lumps, but never early. Readings that were lost become whole periods. Stamps strictly increase. Knows the
/// time from its callers alone.
///
/// What looked like the phase and turns out to have been a delay (the host was held up, and then read much at
/// once) is forgotten as a whole: points that were late are never explained by another period. A stream that
/// has to be corrected all the time is in doubt (RateCheck).
class SampleClock {
 public:
  explicit SampleClock(const SampleClockConfig& config) noexcept : config_(config) { set_rate(1.0); }

  /// The device sends `rate_hz` (positive) readings per second from here on; forgets phase and period.
  void set_rate(double rate_hz) noexcept;

  /// The next reading starts a new phase; the period found so far stays.
  void restart() noexcept { running_ = false; }

  /// `readings` were sent and lost after the last stamped one. A guess does no lasting harm.
  void skip(std::size_t readings) noexcept;

  /// Stamps the next readings, which the device sent at equal distances; the last cannot have begun later
  /// than `latest`.
  void stamp(Stamp latest, std::span<Stamp> into) noexcept;

  /// Whether the stamps just given can be believed: enough readings were seen since the last start to know
  /// the phase within a lump, the newest was not later than two lumps, and the rate is not in doubt. (Later
  /// ones may follow a gap that is not yet known for one, or have been held up; the next windows tell which.)
  [[nodiscard]] bool settled() const noexcept {
    return knows_phase() && !is_in_doubt() && !check_.is_suspect();
  }

  /// Readings do not come as the device was said to send them, second after second: at another rate, some of
  /// them lost or doubled all the time, or too irregularly for their phase to be known.
  [[nodiscard]] bool is_in_doubt() const noexcept { return check_.is_in_doubt(); }
  /// Readings per second that seem to come, losses that are known left out of account; while in doubt.
  [[nodiscard]] double apparent_rate_hz() const noexcept {
    return 1e9 / (nominal_ns_ * (1.0 + check_.period_off()));
  }

  /// Periods without a reading, found from the arrivals alone.
  [[nodiscard]] std::uint64_t missing() const noexcept { return missing_; }
  /// Starts of a new phase after the first.
  [[nodiscard]] std::uint64_t relocks() const noexcept { return relocks_; }
  [[nodiscard]] double period_s() const noexcept { return line_.slope * 1e-9; }

 private:
  struct Window {
    double least_slack = 0.0;
    double readings = 0.0;
    std::size_t calls = 0;
    double first_y = 0.0;  ///< ns after base_
    double last_y = 0.0;
    double pulled_ns = 0.0;  ///< by which the line was put earlier
    LowerLine::Point least{};
  };

  [[nodiscard]] bool knows_phase() const noexcept;
  void lock(Stamp latest) noexcept;
  void renew() noexcept;
  void track(double y) noexcept;
  void pull(double by_ns) noexcept;
  void close_window() noexcept;
  void close_bucket() noexcept;
  void fit() noexcept;
  void move_on(double periods) noexcept;
  void raise(double by_ns) noexcept;
  void set_slope(double slope) noexcept;
  void rebase() noexcept;
  void check(Stamp latest) noexcept;
  void emit(std::span<Stamp> into, double last_ns, double period_ns) noexcept;
  [[nodiscard]] double slope_least() const noexcept {
    return nominal_ns_ * (1.0 - config_.tolerance_ppm * 1e-6);
  }
  [[nodiscard]] double slope_greatest() const noexcept {
    return nominal_ns_ * (1.0 + config_.tolerance_ppm * 1e-6);
  }
  [[nodiscard]] double at(double x) const noexcept { return line_.offset + line_.slope * x; }
  [[nodiscard]] bool is_full(const Window& window, double length_ns, std::size_t calls) const noexcept;

  SampleClockConfig config_;
  double nominal_ns_ = 0.0;
  double known_slope_ = 0.0;  ///< found from enough points, else nominal
  LowerLine points_;
  LowerLine::Line line_{};  ///< nanoseconds after base_ over readings
  Stamp base_{};
  double x_ = 0.0;  ///< index of the newest reading, counted from base_
  Window window_;
  Window bucket_;
  double before_last_ = 0.0;  ///< least slack of the window before the last closed one
  double last_ = 0.0;
  double last_bucket_ = 0.0;  ///< the same of the last closed bucket
  std::size_t windows_ = 0;   ///< closed since the phase began
  Stamp emitted_ = Stamp::min();
  bool running_ = false;
  std::uint64_t missing_ = 0;
  std::uint64_t relocks_ = 0;
  bool ever_ran_ = false;
  bool is_late_ = false;  // the newest reading, by more than two lumps
  RateCheck check_;
  double correction_ns_ = 0.0;  ///< of the line since the last check
  std::optional<Stamp> checked_;
};

}  // namespace slamsensor::hal
