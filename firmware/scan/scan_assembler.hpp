#pragma once

#include "core/reading.hpp"
#include "core/sweep/latency_calibration.hpp"
#include "core/sweep/swept_line.hpp"
#include "firmware/scan/pan_fit.hpp"
#include "firmware/scan/scan_config.hpp"
#include "hal/counters.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::firmware {

using core::Latency;
using core::Scanline;
using core::SweepDirection;

/// What the assembler counts.
enum class AssemblerEvent : std::uint8_t {
  LinesFinished,
  LinesTooFewPolls,      ///< rejected: see PanFitProblem
  LinesTooManyOutliers,  ///< rejected
  LinesWrongSpeed,       ///< rejected
  LinesOffModel,         ///< rejected
  LinesTiltMoved,        ///< rejected: the tilt axis did not rest
  LinesNoReadings,       ///< rejected: the rangefinder said nothing while the axis moved
  ReadingsWeak,          ///< left out: Echo::Weak
  ReadingsSaturated,     ///< left out: Echo::Saturated
  ReadingsFault,         ///< left out: Echo::Fault, or a return without a positive finite distance
  ReadingsOverflow,      ///< no room
  PollsOverflow,         ///< no room
};
inline constexpr std::size_t kAssemblerEvents = 12;

/// Why a line was not made into a scanline: one of the Lines... events above.
using LineRejection = AssemblerEvent;

/// A line that is about to be swept.
struct LineStart {
  std::uint32_t line = 0;
  double tilt_rad = 0.0;  ///< where the tilt axis was last seen to rest; used when it is not polled meanwhile
  double pan_resolution_rad = 0.0;
  double tilt_resolution_rad = 0.0;
};

/// Makes one line's samples of both devices into a scanline. Late data is waited for, so that a line comes
/// out `late_data_s` after its end. No allocation after construction; one thread.
class ScanAssembler {
 public:
  ScanAssembler(const ScanConfig& scan, const PanFitConfig& pan_fit);

  /// Empties the buffers and keeps samples from now on; a line not handed out yet is lost.
  void begin_line(const LineStart& start) noexcept;
  /// The pan axis has come to rest after `move`; samples are kept until `late_data_s` after `now`.
  void end_line(const hal::MotionProfile& move, hal::Stamp now) noexcept;
  /// Forgets the line.
  void abandon() noexcept { state_ = State::Idle; }

  void add(std::span<const hal::RangeSample> samples) noexcept;
  void add(std::span<const hal::AxisSample> samples) noexcept;

  /// The line that is due at `now`, or why it is rejected; nothing while none is. A reading was measured when
  /// the polls show the axis at its stamp + latency.
  [[nodiscard]] std::optional<tl::expected<Scanline, LineRejection>> step(hal::Stamp now,
                                                                          const Latency& latency) noexcept;

  /// Whether begin_line() would lose nothing.
  [[nodiscard]] bool is_idle() const noexcept { return state_ == State::Idle; }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(AssemblerEvent event) const noexcept { return counters_[event]; }
  /// Of the last line that was fitted.
  [[nodiscard]] const PanFit& pan_fit() const noexcept { return fit_; }

 private:
  enum class State : std::uint8_t {
    Idle,     ///< no line
    Open,     ///< the line is being swept
    Closing,  ///< its late data is awaited
  };

  [[nodiscard]] tl::expected<Scanline, LineRejection> assemble(const Latency& latency) noexcept;
  [[nodiscard]] bool measure_tilt() noexcept;
  void fill_readings(double latency_s) noexcept;
  void add_reading(const hal::RangeSample& sample, double pan_rad) noexcept;
  [[nodiscard]] Scanline describe(const Latency& latency) noexcept;
  [[nodiscard]] double median_half_width_s() noexcept;

  PanFitter fitter_;
  hal::Stamp late_data_;
  State state_ = State::Idle;
  LineStart start_;
  hal::MotionProfile move_;
  hal::Stamp due_{};
  PanFit fit_;
  double tilt_rad_ = 0.0;
  std::vector<hal::RangeSample> samples_;
  std::vector<hal::AxisSample> polls_;
  std::vector<hal::Stamp> half_widths_;
  std::vector<core::Reading> readings_;
  std::vector<hal::Stamp> stamps_;
  hal::Counters<AssemblerEvent, kAssemblerEvents> counters_;
};

}  // namespace slamsensor::firmware
