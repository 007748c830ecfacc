#pragma once

#include "core/memory/bounded_vector.hpp"
#include "core/reading.hpp"
#include "core/sweep/latency_calibration.hpp"
#include "core/sweep/pan_fit.hpp"
#include "core/sweep/swept_line.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::core {

/// What the assembler counts.
enum class AssemblerEvent : std::uint8_t {
  LinesFinished,
  LinesTooFewPolls,      ///< rejected: see PanFitProblem
  LinesTooManyOutliers,  ///< rejected
  LinesWrongSpeed,       ///< rejected
  LinesOffModel,         ///< rejected
  LinesTiltMoved,        ///< rejected: the tilt axis did not rest
  LinesNoReadings,       ///< rejected: the rangefinder said nothing while the axis moved
  ReadingsWeak,          ///< left out: EchoKind::Weak
  ReadingsSaturated,     ///< left out: EchoKind::Saturated
  ReadingsFault,         ///< left out: EchoKind::Fault, or a return without a positive finite distance
  ReadingsOverflow,      ///< no room
  PollsOverflow,         ///< no room
};
inline constexpr std::size_t kAssemblerEvents = 12;
inline constexpr std::array<std::string_view, kAssemblerEvents> kAssemblerEventNames = {
    "lines_finished",     "lines_too_few_polls", "lines_too_many_outliers", "lines_wrong_speed",
    "lines_off_model",    "lines_tilt_moved",    "lines_no_readings",       "readings_weak",
    "readings_saturated", "readings_fault",      "readings_overflow",       "polls_overflow"};

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
  ScanAssembler(Arena& arena, const AssemblerConfig& config, const PanFitConfig& pan_fit) noexcept;

  /// Empties the buffers and keeps samples from now on; a line not handed out yet is lost.
  void begin_line(const LineStart& start) noexcept;
  /// The pan axis has come to rest after `move`, whose model stays as it is until the line is out; samples
  /// are kept until `late_data_s` after `now`.
  void end_line(const AxisPath& move, std::chrono::nanoseconds now) noexcept;
  /// Forgets the line.
  void abandon() noexcept { state_ = State::Idle; }

  void add(const TimedRange& sample) noexcept;
  void add(const TimedAngle& sample) noexcept;

  /// The line that is due at `now`, or why it is rejected; nothing while none is. A reading was measured when
  /// the polls show the axis at its stamp + latency.
  [[nodiscard]] std::optional<Outcome<Scanline, LineRejection>> step(std::chrono::nanoseconds now,
                                                                     const Latency& latency) noexcept;

  /// Whether begin_line() would lose nothing.
  [[nodiscard]] bool is_idle() const noexcept { return state_ == State::Idle; }
  [[nodiscard]] std::span<const std::uint64_t> counts() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(AssemblerEvent event) const noexcept { return counters_[event]; }
  /// Of the last line that was fitted.
  [[nodiscard]] const PanFit& pan_fit() const noexcept { return fit_; }

 private:
  enum class State : std::uint8_t {
    Idle,     ///< no line
    Open,     ///< the line is being swept
    Closing,  ///< its late data is awaited
  };

  [[nodiscard]] Outcome<Scanline, LineRejection> assemble(const Latency& latency) noexcept;
  [[nodiscard]] bool measure_tilt() noexcept;
  void fill_readings(double latency_s) noexcept;
  void add_reading(const TimedRange& sample, double pan_rad) noexcept;
  [[nodiscard]] Scanline describe(const Latency& latency) noexcept;
  [[nodiscard]] double median_half_width_s() noexcept;

  PanFitter fitter_;
  std::chrono::nanoseconds late_data_;
  State state_ = State::Idle;
  LineStart start_;
  AxisPath move_;
  std::chrono::nanoseconds due_{};
  PanFit fit_;
  double tilt_rad_ = 0.0;
  BoundedVector<TimedRange> samples_;
  BoundedVector<TimedAngle> polls_;
  BoundedVector<std::chrono::nanoseconds> half_widths_;
  BoundedVector<Reading> readings_;
  BoundedVector<std::chrono::nanoseconds> stamps_;
  EventCounts<AssemblerEvent, kAssemblerEvents> counters_;
};

}  // namespace slamsensor::core
