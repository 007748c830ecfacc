#pragma once

#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::hal {

/// When the bytes of a serial line arrived, by their place in the stream, which counts from 0.
class ArrivalLog {
 public:
  /// `count` more bytes were read at `stamp`, which does not decrease.
  void note(std::size_t count, Stamp stamp) noexcept;

  /// Place of the byte that comes next.
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

  /// The latest moment at which the record of the bytes [begin, end) can have begun on a line of `baud`
  /// bit/s: the line also had to carry the record and all that the same read brought after it. Never earlier
  /// than the truth; later when the record was read too long ago for the log to know when. begin < end <=
  /// position().
  [[nodiscard]] Stamp latest_begin(std::uint64_t begin, std::uint64_t end, std::uint32_t baud) const noexcept;

 private:
  struct Read {
    std::uint64_t end = 0;  ///< place after the last byte of the read
    Stamp stamp{};
  };
  static constexpr std::size_t kReads = 64;

  std::array<Read, kReads> reads_{};
  std::size_t newest_ = 0;
  std::size_t count_ = 0;
  std::uint64_t position_ = 0;
};

/// The line under a cloud of points (x grows): none lies below it, and the sum of their heights above it is
/// the least possible, among lines whose slope stays within bounds. Points that are late by chance leave it
/// where it is. (Moon, Skelly and Towsley: "Estimation and removal of clock skew from network delay
/// measurements", INFOCOM 1999.)
class LowerLine {
 public:
  struct Point {
    double x = 0.0;
    double y = 0.0;
  };
  struct Line {
    double slope = 0.0;
    double offset = 0.0;  ///< at x = 0
  };
  static constexpr std::size_t kPointsMax = 64;

  void clear() noexcept { count_ = 0; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// Takes a point with x greater than all before; the oldest leaves when there are kPointsMax.
  void add(const Point& point) noexcept;

  /// Moves the origin of all points.
  void shift(double dx, double dy) noexcept;

  struct Slopes {
    double least = 0.0;
    double greatest = 0.0;
    double otherwise = 0.0;  ///< what a single point gets; between the two
  };
  /// There must be at least one point.
  [[nodiscard]] Line fit(const Slopes& slopes) const noexcept;

  /// Takes back the newest point. There must be one.
  void drop_newest() noexcept { --count_; }

 private:
  [[nodiscard]] double hull_slope(double fallback) const noexcept;

  std::array<Point, kPointsMax> points_{};
  std::size_t count_ = 0;
};

/// What the last seconds say of the rate of a stream.
enum class RateVerdict : std::uint8_t {
  Unchanged,  ///< nothing new
  Corrected,  ///< the clock was corrected all the time: its period is wrong, and period_off() is nearer
  InDoubt,    ///< the stream is not what it was said to be
};

/// Whether a clock that follows a periodic stream has to be corrected all the time. When the rate that shows
/// then lies within the tolerance, the clock's period is wrong; when it does not, the stream is in doubt: the
/// device has another rate, or readings are lost or doubled all the time. One event (a gap, a stall) does no
/// harm. Looks at the last eight intervals of 0.25 s or more.
class RateCheck {
 public:
  /// `tolerance` is the share by which the true rate may be off the nominal one; `period_ns` the nominal
  /// period. A doubt lasts until the new stream has proved it wrong.
  void begin(double tolerance, double period_ns) noexcept;

  /// `elapsed_ns` have passed by arrival (0 or more) since the last call. Meanwhile the clock was put forward
  /// by `correction_ns` beside its period, which is off the nominal one by `slope_off` (a share). While the
  /// verdict is not Unchanged, the period that the clock goes on with is to be the nominal one (InDoubt), or
  /// the nominal one with period_off().
  RateVerdict add(double elapsed_ns, double correction_ns, double slope_off, bool is_settled) noexcept;

  /// From a rate beyond its tolerance, or less than half the time settled, until neither has been the case
  /// for a second and a half.
  [[nodiscard]] bool is_in_doubt() const noexcept { return in_doubt_; }

  /// The last two intervals already show a rate beyond its tolerance.
  [[nodiscard]] bool is_suspect() const noexcept { return is_suspect_; }

  /// How much longer than nominal the period seems to be over the last intervals, as a share.
  [[nodiscard]] double period_off() const noexcept { return period_off_; }

 private:
  static constexpr std::size_t kIntervals = 8;
  static constexpr std::size_t kExtremes = 2;  // to each side, left out of means
  struct Interval {
    double elapsed_ns = 0.0;
    double correction_ns = 0.0;
    double slope_off_ns = 0.0;
    double unsettled_ns = 0.0;
  };

  [[nodiscard]] RateVerdict judge() noexcept;

  double tolerance_ = 0.0;
  double period_ns_ = 0.0;
  double interval_ns_ = 0.0;
  Interval open_;
  std::array<double, kIntervals> corrections_{};  // shares of the interval
  std::array<double, kIntervals> periods_off_{};
  std::array<bool, kIntervals> unsettled_{};
  std::size_t closed_ = 0;
  double period_off_ = 0.0;
  double last_off_ = 0.0;
  bool is_suspect_ = false;
  bool in_doubt_ = false;
};

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
  /// ones may follow a gap that is not yet known for one, or have been held up; the next windows show which.)
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
