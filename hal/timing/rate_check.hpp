#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::hal {

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

}  // namespace slamsensor::hal
