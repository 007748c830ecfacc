#pragma once

#include "firmware/scan/scan_config.hpp"
#include "firmware/scan/scan_plan.hpp"
#include "hal/counters.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

/// Why a pass was ended before its end.
enum class ScanAbort : std::uint8_t {
  PanTiltLost,
  RangefinderLost,
  MoveRefused,
  PanStalled,     ///< the pan axis was not there in time, or came to rest elsewhere
  TiltStalled,    ///< the same of the tilt axis
  LinesRejected,  ///< more than the allowed share of them
  HeadMoved,      ///< an axis that was to rest was pushed off its place
  CarrierMoved,   ///< the lines of the scan were not swept from one place: see MotionDetector
  TimingInDoubt,  ///< what was measured when is not known well enough: see ScanDoubt
  Held,           ///< scanning is not allowed any more
  Cancelled,      ///< on command
};
inline constexpr std::size_t kScanAborts = 11;

/// Lower snake case, in the order of the enumerators.
inline constexpr std::array<std::string_view, kScanAborts> kScanAbortNames = {
    "pan_tilt_lost", "rangefinder_lost", "move_refused",    "pan_stalled", "tilt_stalled", "lines_rejected",
    "head_moved",    "carrier_moved",    "timing_in_doubt", "held",        "cancelled"};

/// What puts the timing of a whole scan in doubt.
enum class ScanDoubt : std::uint8_t {
  Device,          ///< a device's samples cannot be timed: hal::Device::timing_doubt()
  PositionsLoose,  ///< the pan was known too loosely for its speed in too many lines
  LatencyUnknown,  ///< it was so because nothing has shown the latency between the devices yet
  OtherLatency,    ///< what the lines saw shows another latency than is known
};
inline constexpr std::size_t kScanDoubts = 4;

/// A sentence for a person: which device it is, what happened and what to do about it. Lives as long as the
/// program.
[[nodiscard]] std::string_view describe(ScanDoubt doubt) noexcept;

/// Why no scan may be made. Each is set and lifted by itself; one of them is enough.
enum class HoldReason : std::uint8_t {
  InterlockOpen,  ///< the laser interlock is open, or cannot be read
  Paused,         ///< on command
  LeanUnknown,    ///< the inclinometer has reported nothing, or nothing for too long
  LeansTooFar,    ///< the sensor leans by more than it may
};
inline constexpr std::size_t kHoldReasons = 4;

/// As above.
[[nodiscard]] std::string_view describe(HoldReason reason) noexcept;

enum class AxisMoveState : std::uint8_t {
  Asking,   ///< the unit has not taken the move yet
  Moving,   ///< taken; the axis is under way
  Arrived,  ///< polls show the axis at rest at the target
  Refused,  ///< the unit cannot go there
  Stalled,  ///< not there in time, or at rest elsewhere
};

/// One move of one axis, asked for until it is taken and watched until it has ended. A value.
class AxisMove {
 public:
  /// No move: Arrived.
  AxisMove() noexcept = default;

  /// A move to `target_rad` that may take `margin` longer than the unit's motion model says. An axis that
  /// rests there already has arrived.
  AxisMove(hal::Axis axis, double target_rad, double speed_radps, hal::Stamp margin) noexcept;

  /// Asks `unit`, which is Ready, or looks whether it has arrived.
  AxisMoveState step(hal::PanTilt& unit, hal::Stamp now) noexcept;

  [[nodiscard]] AxisMoveState state() const noexcept { return state_; }
  [[nodiscard]] hal::Axis axis() const noexcept { return axis_; }
  [[nodiscard]] double target_rad() const noexcept { return target_rad_; }
  [[nodiscard]] double speed_radps() const noexcept { return speed_radps_; }
  /// Where the axis stood when the move was asked for, where it was seen last, and how long after that.
  [[nodiscard]] double start_rad() const noexcept { return start_rad_; }
  [[nodiscard]] double seen_rad() const noexcept { return seen_rad_; }
  [[nodiscard]] hal::Stamp waited() const noexcept { return waited_; }

 private:
  void ask(hal::PanTilt& unit, hal::Stamp now) noexcept;
  void watch(const hal::AxisStatus& status, double resolution_rad, hal::Stamp now) noexcept;

  hal::Axis axis_ = hal::Axis::Pan;
  double target_rad_ = 0.0;
  double speed_radps_ = 0.0;
  hal::Stamp margin_{};
  AxisMoveState state_ = AxisMoveState::Arrived;
  double start_rad_ = 0.0;
  double seen_rad_ = 0.0;
  hal::Stamp asked_{};
  hal::Stamp waited_{};
  hal::Stamp taken_{};
  hal::Stamp deadline_ = hal::kNever;
  bool has_moved_ = false;
};

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
  AbortedHeadMoved,
  AbortedCarrierMoved,
  AbortedTimingInDoubt,
  AbortedHeld,
  AbortedCancelled,
  PlansRefused,  ///< see plan_problem()
  LinesSwept,
  HoldsBegun,         ///< from free to held
  RequestsJoined,     ///< requests while one was waiting: they get the same scan
  RequestsCancelled,  ///< by abort_scan()
};
inline constexpr std::size_t kSchedulerEvents = 18;

/// What a step must know of the other stations.
struct SchedulerGates {
  bool assembler_idle = true;  ///< a line may begin
  bool latency_idle = true;    ///< a pass may end: the latency that it shows is known
};

/// Leads a pan-tilt unit through scans: to the start, a line, a step up, a line back, and on to the last
/// line; before the first scan the same at one tilt for the latency. A pass is given up for a ScanAbort, the
/// unit is halted, and it is begun again after `retry_s` (after a hold: at once), when both devices are
/// Ready, their timing is not in doubt, and nothing holds it. The plan is made anew for each pass, from what
/// the unit reports then. No clock, no allocation; one thread.
class ScanScheduler {
 public:
  /// Both devices outlive this and are stepped by the caller.
  ScanScheduler(hal::PanTilt& pan_tilt, const hal::Rangefinder& rangefinder,
                const ScanConfig& config) noexcept;

  [[nodiscard]] SchedulerAction step(hal::Stamp now, const SchedulerGates& gates) noexcept;

  /// One more scan; the calibration pass precedes the first one. In ScanMode::Continuous the next one will
  /// do. While a scan is under way or cannot be made yet, one request waits; more are joined to it.
  void request_scan() noexcept;
  /// From now on; a scan under way is finished. ScanMode::OneShot asks for its scan.
  void set_mode(ScanMode mode) noexcept;
  /// The pass under way ends in the next step, and what was requested is forgotten. In ScanMode::Continuous
  /// the next scan begins after `retry_s`.
  void abort_scan() noexcept;

  /// No pass goes on or begins from the next step on, until release(): the pass under way is aborted
  /// (ScanAbort::Held) and the unit halted. A request outlives the hold.
  void hold(HoldReason reason) noexcept;
  /// Lifts `reason`; scanning goes on, from a new scan, when no other holds it.
  void release(HoldReason reason) noexcept;
  /// The first of the reasons that hold it.
  [[nodiscard]] std::optional<HoldReason> held() const noexcept;

  /// The scan under way was not made from one place: it is aborted in the next step.
  void on_carrier_moved() noexcept { carrier_moved_ = true; }
  /// A line of this pass could not be used.
  void on_line_rejected() noexcept { ++lines_rejected_; }

  [[nodiscard]] ScanMode mode() const noexcept { return config_.mode; }
  [[nodiscard]] bool is_requested() const noexcept { return requested_; }
  [[nodiscard]] SchedulerState state() const noexcept { return state_; }
  [[nodiscard]] ScanPass pass() const noexcept { return pass_; }
  [[nodiscard]] const ScanPlan& plan() const noexcept { return plan_; }
  /// Number of the line under way, from 0; after LineEnded the next one's.
  [[nodiscard]] std::uint32_t line() const noexcept { return line_; }
  [[nodiscard]] std::uint32_t lines_rejected() const noexcept { return lines_rejected_; }
  /// Of the last aborted pass.
  [[nodiscard]] ScanAbort abort_reason() const noexcept { return abort_reason_; }
  /// The move under way of one axis, or the last one; of an aborted pass that which it was aborted in.
  [[nodiscard]] const AxisMove& move(hal::Axis axis) const noexcept {
    return axis == hal::Axis::Pan ? pan_ : tilt_;
  }
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
  [[nodiscard]] bool rests_elsewhere() const noexcept;
  [[nodiscard]] bool is_timing_in_doubt() const noexcept;
  [[nodiscard]] SchedulerAction abort(ScanAbort reason, hal::Stamp now) noexcept;
  void halt() noexcept;
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
  bool serves_request_ = false;  // the scan under way
  bool cancelled_ = false;       // the pass under way, on command
  bool carrier_moved_ = false;
  bool halt_due_ = false;
  std::array<bool, kHoldReasons> holds_{};
  hal::EventCounters<SchedulerEvent, kSchedulerEvents> counters_;
};

}  // namespace slamsensor::firmware
