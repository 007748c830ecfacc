#pragma once

#include "firmware/scan/axis_move.hpp"
#include "firmware/scan/scan_config.hpp"
#include "firmware/scan/scan_plan.hpp"
#include "hal/counters.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

enum class SchedulerState : std::uint8_t {
  Waiting,      ///< for the devices, for a request, or for the rest after an aborted pass to be over
  Positioning,  ///< pan goes to the start of the line, tilt to its height
  Settling,     ///< both are there; vibration dies down, the line before is finished
  Sweeping,     ///< pan goes to the end of the line
  Finishing,    ///< the last line's late data is awaited
};

/// What lines are swept for.
enum class ScanPass : std::uint8_t {
  Calibration,  ///< to and fro at one tilt, for the latency between the devices
  Scan,
};

/// Why a pass was ended before its end.
enum class ScanAbort : std::uint8_t {
  PanTiltLost,
  RangefinderLost,
  MoveRefused,
  PanStalled,
  TiltStalled,
  LinesRejected,  ///< more than the allowed share of them
};

/// What happened in a step, at most one thing.
enum class SchedulerAction : std::uint8_t { None, PassBegun, LineBegun, LineEnded, PassEnded, PassAborted };

enum class SchedulerEvent : std::uint8_t {
  ScansFinished,
  CalibrationsFinished,
  AbortedPanTiltLost,  ///< passes; in the order of ScanAbort
  AbortedRangefinderLost,
  AbortedMoveRefused,
  AbortedPanStalled,
  AbortedTiltStalled,
  AbortedLinesRejected,
  PlansRefused,  ///< see plan_problem()
  LinesSwept,
};
inline constexpr std::size_t kSchedulerEvents = 10;

/// What a step must know of the other stations.
struct SchedulerGates {
  bool assembler_idle = true;  ///< a line may begin
  bool latency_idle = true;    ///< a calibration pass may end
};

/// Leads a pan-tilt unit through scans: to the start, a line, a step up, a line back, and on to the last
/// line; before the first scan the same at one tilt for the latency. A pass is given up when a device leaves
/// Ready, a move is refused or does not end in time, or too many lines are rejected; it is begun again after
/// `retry_s`, when both devices are Ready. The plan is made anew for each pass, from what the unit tells
/// then. No clock, no allocation; one thread.
class ScanScheduler {
 public:
  /// Both devices outlive this and are stepped by the caller.
  ScanScheduler(hal::PanTilt& pan_tilt, const hal::Rangefinder& rangefinder,
                const ScanConfig& config) noexcept;

  [[nodiscard]] SchedulerAction step(hal::Stamp now, const SchedulerGates& gates) noexcept;

  /// One more scan, in ScanMode::Single; the calibration pass precedes the first one.
  void request_scan() noexcept { requested_ = true; }
  /// A line of this pass could not be used.
  void on_line_rejected() noexcept { ++lines_rejected_; }

  [[nodiscard]] SchedulerState state() const noexcept { return state_; }
  [[nodiscard]] ScanPass pass() const noexcept { return pass_; }
  [[nodiscard]] const ScanPlan& plan() const noexcept { return plan_; }
  /// Number of the line under way, from 0; after LineEnded the next one's.
  [[nodiscard]] std::uint32_t line() const noexcept { return line_; }
  [[nodiscard]] std::uint32_t lines_rejected() const noexcept { return lines_rejected_; }
  /// Of the last aborted pass.
  [[nodiscard]] ScanAbort abort_reason() const noexcept { return abort_reason_; }
  /// Why there is no plan, while there is none.
  [[nodiscard]] const std::optional<PlanProblem>& plan_problem() const noexcept { return plan_problem_; }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(SchedulerEvent event) const noexcept { return counters_[event]; }

 private:
  [[nodiscard]] SchedulerAction wait(hal::Stamp now) noexcept;
  [[nodiscard]] SchedulerAction position(hal::Stamp now) noexcept;
  [[nodiscard]] SchedulerAction settle(hal::Stamp now, const SchedulerGates& gates) noexcept;
  [[nodiscard]] SchedulerAction sweep(hal::Stamp now) noexcept;
  [[nodiscard]] SchedulerAction finish(hal::Stamp now, const SchedulerGates& gates) noexcept;
  [[nodiscard]] std::optional<ScanAbort> find_abort() const noexcept;
  [[nodiscard]] SchedulerAction abort(ScanAbort reason, hal::Stamp now) noexcept;
  [[nodiscard]] bool make_plan() noexcept;
  void begin_line(std::uint32_t line) noexcept;
  [[nodiscard]] std::uint32_t line_count() const noexcept;
  [[nodiscard]] double pan_start_rad() const noexcept;
  [[nodiscard]] double pan_end_rad() const noexcept;
  [[nodiscard]] bool is_leftwards() const noexcept { return first_leftwards_ == (line_ % 2 == 0); }

  hal::PanTilt& pan_tilt_;
  const hal::Rangefinder& rangefinder_;
  ScanConfig config_;
  ScanPlan plan_;
  std::optional<PlanProblem> plan_problem_;
  SchedulerState state_ = SchedulerState::Waiting;
  ScanPass pass_ = ScanPass::Calibration;
  ScanAbort abort_reason_ = ScanAbort::PanTiltLost;
  AxisMove pan_;
  AxisMove tilt_;
  hal::Stamp until_{};  // of waiting or settling
  std::uint32_t line_ = 0;
  std::uint32_t lines_rejected_ = 0;
  bool calibrated_;
  bool first_leftwards_ = true;
  bool requested_ = false;
  hal::Counters<SchedulerEvent, kSchedulerEvents> counters_;
};

}  // namespace slamsensor::firmware
