#pragma once

#include "core/reading.hpp"
#include "core/sweep/latency_calibration.hpp"
#include "core/sweep/motion_detector.hpp"
#include "core/sweep/scan_assembler.hpp"
#include "core/sweep/swept_line.hpp"
#include "firmware/arena_block.hpp"
#include "firmware/scan/scan_config.hpp"
#include "firmware/scan/scan_failure.hpp"
#include "firmware/scan/scan_scheduler.hpp"
#include "hal/counters.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"
#include "hal/ring.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace slamsensor::firmware {

using core::Scanline;
using core::SweepDirection;

// Where the names of hal end. The move outlives its path.
[[nodiscard]] core::AxisPath path_of(const hal::MotionProfile& move) noexcept;
[[nodiscard]] core::TimedAngle timed(const hal::AxisSample& sample) noexcept;
[[nodiscard]] core::TimedRange timed(const hal::RangeSample& sample) noexcept;

/// A scan has begun; its scanlines follow.
struct ScanBegun {
  std::uint32_t scan = 0;  ///< number, from 0; aborted ones count
};

/// All scanlines of a scan are out. Times are stamps of its first and last reading.
struct ScanEnded {
  std::uint32_t scan = 0;
  hal::Stamp begin{};
  hal::Stamp middle{};
  hal::Stamp end{};
  std::uint32_t lines = 0;           ///< handed out
  std::uint32_t lines_rejected = 0;  ///< swept, but not fit to be handed out
  hal::Stamp known{};                ///< when the head came to know of the end
};

/// A scan was given up; what its scanlines showed is to be forgotten.
struct ScanAborted {
  std::uint32_t scan = 0;
  ScanAbort reason = ScanAbort::PanTiltLost;
};

/// What a sensor head does, in its order: to the SLAM thread (ScanQueue), from a tape, in a test.
using HeadEvent = std::variant<ScanBegun, Scanline, ScanEnded, ScanAborted>;

enum class HeadEventCount : std::uint8_t {
  LinesLoose,         ///< not handed out: ScanConfig::pan_sigma_max_rad
  ScansLoose,         ///< given up at their end: too many of these
  ScansOtherLatency,  ///< given up at their end: ScanDoubt::OtherLatency
};

/// A pan-tilt unit and a rangefinder that make scans, levelled when it is known how the sensor leans: the
/// readings handed out are in the level frame (core::Attitude) then, those that the latency and the carrier's
/// motion are found from are the head's own. The body of the scan thread: whoever steps it supplies
/// the time, so that the live sensor, an emulated one and a recording run the same code. No clock, no thread;
/// no allocation after construction.
class SensorHead {
 public:
  /// Both devices outlive this; it steps them.
  SensorHead(hal::PanTilt& pan_tilt, hal::Rangefinder& rangefinder, const SensorHeadConfig& config);

  /// Steps both drivers, takes their samples, leads the scan on. `now` never decreases; at least every 10 ms.
  void step(hal::Stamp now) noexcept;

  /// The next thing that happened, in order. Take all after each step: the spans of a Scanline are valid
  /// until the next step, and of what is left lying the newest is dropped and counted.
  [[nodiscard]] std::optional<HeadEvent> take() noexcept;

  /// As ScanScheduler says of each.
  void request_scan() noexcept { scheduler_.request_scan(); }
  void set_mode(ScanMode mode) noexcept { scheduler_.set_mode(mode); }
  void abort_scan() noexcept { scheduler_.abort_scan(); }
  void hold(HoldReason reason) noexcept { scheduler_.hold(reason); }
  void release(HoldReason reason) noexcept { scheduler_.release(reason); }

  /// The inclinometer reports this attitude. Only with LevellingConfig::has_inclinometer(); one that
  /// is not finite is passed over. Until the first one the head is held (HoldReason::LeanUnknown), and again
  /// whenever the caller holds it for that reason.
  void incline(const core::Attitude& reported) noexcept;

  /// How the sensor leans, as it was reported last; nothing before that, and when it is not asked for.
  [[nodiscard]] std::optional<core::Attitude> attitude() const noexcept { return attitude_; }

  /// What keeps it from scanning, for a person; empty when nothing does. Valid until the next step().
  [[nodiscard]] std::string_view problem() const noexcept;
  /// The devices answer, but no scan comes of it: problem() says why.
  [[nodiscard]] bool is_failing() const noexcept;
  /// Of the last pass that was aborted.
  [[nodiscard]] std::optional<ScanAbort> last_abort() const noexcept { return last_abort_; }

  [[nodiscard]] const ScanScheduler& scheduler() const noexcept { return scheduler_; }
  [[nodiscard]] const core::ScanAssembler& assembler() const noexcept { return *assembler_; }
  [[nodiscard]] const core::LatencyCalibration& calibration() const noexcept { return calibration_; }
  [[nodiscard]] const core::MotionDetector& motion() const noexcept { return motion_; }
  [[nodiscard]] const core::Latency& latency() const noexcept { return calibration_.latency(); }
  /// Why the last scan that was made to its end gave nothing, if its timing was in doubt.
  [[nodiscard]] const std::optional<ScanDoubt>& doubt() const noexcept { return doubt_; }
  /// The timing of a device is in doubt now.
  [[nodiscard]] bool is_timing_in_doubt() const noexcept;
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  /// What the rangefinder said since construction, echo or none.
  [[nodiscard]] std::uint64_t readings() const noexcept { return readings_; }
  /// Events that nobody took, since construction.
  [[nodiscard]] std::uint64_t events_dropped() const noexcept { return events_dropped_; }

 private:
  static constexpr std::size_t kEventsMax = 8;

  void take_samples() noexcept;
  void act(SchedulerAction action, hal::Stamp now) noexcept;
  void begin_pass() noexcept;
  void begin_line() noexcept;
  void end_pass(hal::Stamp now) noexcept;
  void abort_pass() noexcept;
  void finish_line(hal::Stamp now) noexcept;
  void hand_out(const Scanline& line) noexcept;
  [[nodiscard]] Scanline levelled(Scanline line) noexcept;
  void calibrate() noexcept;
  void push(const HeadEvent& event) noexcept;
  [[nodiscard]] std::optional<ScanDoubt> judge_timing() noexcept;
  [[nodiscard]] bool in_scan() const noexcept { return scheduler_.pass() == ScanPass::Scan; }

  hal::PanTilt& pan_tilt_;
  hal::Rangefinder& rangefinder_;
  ScanScheduler scheduler_;
  ArenaBlock<core::ScanAssembler> assembler_;
  hal::MotionProfile move_;  // of the last line
  core::LatencyCalibration calibration_;
  core::MotionDetector motion_;
  LevellingConfig levelling_;
  std::optional<core::Attitude> attitude_;       // of the sensor, now
  std::optional<core::Attitude> scan_attitude_;  // at the beginning of the scan
  std::vector<core::Reading> levelled_;          // of the line that was handed out last
  bool calibration_due_ = false;                 // a pass has ended; its last pair may still be at work
  ScanEnded scan_;                               // under way
  std::uint32_t scans_ = 0;
  std::optional<ScanAbort> last_abort_;
  ScanFailure failure_;
  ReadingsWatch readings_watch_;
  bool is_sweeping_ = false;    // between the beginning and the end of a line
  bool stuck_in_scan_ = false;  // a line of the scan under way told nothing
  hal::Stamp stepped_{};
  hal::Stamp resumed_{};  // when steps went on after nobody had made any for a while
  double pan_sigma_max_rad_;
  double loose_max_share_;
  std::uint32_t lines_loose_ = 0;  // of the scan under way
  std::optional<ScanDoubt> doubt_;
  hal::EventCounters<HeadEventCount, 3> counters_;
  hal::Ring<HeadEvent, kEventsMax> events_;
  std::uint64_t events_dropped_ = 0;
  std::uint64_t readings_ = 0;
  std::array<hal::RangeSample, 512> ranges_;
  std::array<hal::AxisSample, 64> positions_;
};

}  // namespace slamsensor::firmware
