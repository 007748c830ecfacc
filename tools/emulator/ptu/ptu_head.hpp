#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/ptu/motion_plan.hpp"
#include "tools/world/random.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Axes in the order of all arrays here.
enum class PtuAxisId : std::uint8_t { Pan, Tilt };

inline constexpr std::size_t kPtuAxes = 2;

[[nodiscard]] constexpr std::size_t index_of(PtuAxisId axis) noexcept {
  return static_cast<std::size_t>(axis);
}

enum class PtuKind : std::uint8_t { D46_17_5, D46_70, E46_17_5, D300E };

/// Which command language: the D46 manual's, or the larger one of the E-series Command Reference.
enum class PtuSeries : std::uint8_t { Dp, E };

/// An axis as it leaves the factory. Speeds in positions/s, acceleration in positions/s^2.
struct PtuAxisModel {
  double resolution_arcsec = 0.0;  ///< of one position
  long min_position = 0;           ///< limits as a typical unit finds them at its reset
  long max_position = 0;
  long speed = 0;
  long acceleration = 0;
  long base_speed = 0;
  long lower_speed = 0;
  long upper_speed = 0;
  long upper_speed_max = 0;  ///< what the upper bound can be raised to
};

struct PtuModel {
  std::string_view name;
  PtuSeries series = PtuSeries::Dp;
  PtuAxisModel pan;
  PtuAxisModel tilt;
};

/// The figures of `kind`. Those of the D46-17.5 are from the PTU-D46 User's Manual 2.14; of the others the
/// resolution and the speeds that manuals give, the ranges in degrees from the data sheets.
[[nodiscard]] const PtuModel& ptu_model(PtuKind kind);

/// Firmware whose texts are known: Directed Perception 1.09 and 2.12 (its manual 2.14), FLIR E-series 3.3.
enum class PtuFirmware : std::uint8_t { Dp109, Dp212, FlirE33 };

/// What the unit says, without the leading mark and the line end. "%a" stands for "Pan" or "Tilt", "%n" for a
/// number or a word. The defaults are those of the PTU-D46 User's Manual 2.14 and of captured traffic.
struct PtuWording {
  std::string banner =
      "\r\n\r\n### PAN-TILT CONTROLLER\r\n### v2.12.1d1(C14/E), (C)2003 Directed Perception, Inc., All "
      "Rights "
      "Reserved\r\nInitializing...";
  std::string version =
      "Pan-Tilt Controller v2.12.1d1(C14/E), (C)2003 Directed Perception, Inc., All Rights Reserved";
  std::string environment_terse = "Input 30 VDC @ 86 degF";
  std::string current_position = "Current %a position is %n";
  std::string desired_position = "Current %a position is %n";
  std::string min_position = "Minimum %a position is %n";
  std::string max_position = "Maximum %a position is %n";
  std::string desired_speed = "Desired %a speed is %n positions/sec";
  std::string current_speed = "Current %a speed is %n positions/sec";
  std::string acceleration = "%a acceleration is %n positions/sec^2";
  std::string base_speed = "Current %a base speed is %n positions/sec";
  std::string max_speed = "Maximum %a speed is %n positions/sec";
  std::string min_speed = "Minimum %a speed is %n positions/sec";
  std::string resolution = "%n seconds arc per %a position";
  std::string limits_on = "Limit bounds are ENABLED (soft limits enabled)";
  std::string limits_off = "Limit bounds are DISABLED (hard limits only: use care)";
  std::string independent = "independent (default) speed control mode";
  std::string velocity = "pure velocity speed control mode";
  // Errors
  std::string above_max = "Maximum allowable %a position is %n";
  std::string below_min = "Minimum allowable %a position is %n";
  std::string speed_above = "%a speed cannot exceed %n positions/sec";
  std::string speed_below = "Motor speed cannot be less than %n pos/sec";
  std::string illegal_argument = "Illegal argument";
  std::string illegal_command = "Illegal command";
  std::string axis_error = "Axis Error";
  std::string reset_failed = "%a axis reset failed";
  std::string in_motion = "Illegal while axis is in motion";
};

[[nodiscard]] PtuWording ptu_wording(PtuFirmware firmware);

/// `pattern` with `axis` and `value` put in.
[[nodiscard]] std::string worded(std::string_view pattern, std::string_view axis, std::string_view value);

/// Whether, with the echo off, an LF precedes the answer to a command that CR or LF ended.
enum class PtuLeadingLf : std::uint8_t { Never, AfterLine };

/// What RE, RP and RT do: choose the reset of the next power-up (D46 manual), or that and reset (E-series).
enum class PtuResetWords : std::uint8_t { Choose, ChooseAndReset };

/// Whether !T and !P stand between banner and the '*' that ends the power-up reset.
enum class PtuStartReports : std::uint8_t { Silent, Told };

/// How the unit is found when the emulation begins.
enum class PtuBegin : std::uint8_t { PowerUp, Ready };

/// How long the unit is deaf after a command that makes it compute its speed tables anew.
struct PtuTableTimes {
  Stamp acceleration = std::chrono::seconds(2);
  Stamp base = std::chrono::seconds(2);
  Stamp lower = std::chrono::milliseconds(6500);
  Stamp upper = std::chrono::seconds(300);
};

/// All that differs between units.
struct PtuSettings {
  PtuModel model = ptu_model(PtuKind::D46_17_5);
  PtuWording wording;
  PtuLeadingLf leading_lf = PtuLeadingLf::Never;
  PtuResetWords reset_words = PtuResetWords::Choose;
  PtuStartReports start_reports = PtuStartReports::Told;
  PtuBegin begin = PtuBegin::PowerUp;
  std::uint32_t factory_baud = 9600;
  Delay reply_latency = {std::chrono::milliseconds(3), std::chrono::milliseconds(1)};
  Stamp position_latency{};                          ///< age of a position when its query is parsed
  Stamp boot_time = std::chrono::milliseconds(500);  ///< from power to banner
  Stamp reset_time = std::chrono::seconds(30);       ///< of both axes; one axis takes half of it
  PtuTableTimes table_times;
  long limit_spread = 1;  ///< units find their limits within this of the model's
};

/// The settings of a unit of `kind` with the firmware of its time.
[[nodiscard]] PtuSettings ptu_settings(PtuKind kind);

enum class PtuControl : std::uint8_t { Independent, Velocity };
enum class PtuExecution : std::uint8_t { Immediate, Slaved };
enum class PtuLimits : std::uint8_t { On, Off };
enum class PtuEcho : std::uint8_t { On, Off };
enum class PtuFeedback : std::uint8_t { Verbose, Terse };

/// Which axes are reset.
struct PtuAxes {
  bool pan = true;
  bool tilt = true;
  [[nodiscard]] bool any() const noexcept { return pan || tilt; }
};

/// What can be set of an axis. Positions/s, positions/s^2.
struct PtuAxisConfig {
  long speed = 0;
  long acceleration = 0;
  long base_speed = 0;
  long lower_speed = 0;
  long upper_speed = 0;
};

/// All that DS saves, DR brings back, and DF and the factory set.
struct PtuMemory {
  std::array<PtuAxisConfig, kPtuAxes> axes;
  PtuEcho echo = PtuEcho::On;
  PtuFeedback feedback = PtuFeedback::Verbose;
  PtuLimits limits = PtuLimits::On;
  PtuControl control = PtuControl::Independent;
  PtuExecution execution = PtuExecution::Immediate;
  PtuAxes power_up_reset;
  std::uint8_t unit_id = 0;
  std::uint32_t start_baud = 9600;
};

[[nodiscard]] PtuMemory factory_config(const PtuSettings& settings);

[[nodiscard]] inline const PtuAxisModel& model_of(const PtuSettings& settings, PtuAxisId axis) noexcept {
  return axis == PtuAxisId::Pan ? settings.model.pan : settings.model.tilt;
}

/// A stepper axis with its limits, where it is and where it goes. Positions in steps.
class StepperAxis {
 public:
  /// Rests at home, with limits `min_offset` and `max_offset` beside the model's.
  StepperAxis(const PtuAxisModel& model, long hard_margin, long min_offset, long max_offset);

  [[nodiscard]] long min() const noexcept { return min_; }
  [[nodiscard]] long max() const noexcept { return max_; }
  [[nodiscard]] double resolution_arcsec() const noexcept { return resolution_arcsec_; }

  /// Where the present motion ends, or the axis rests.
  [[nodiscard]] long target() const noexcept { return target_; }
  [[nodiscard]] long position(Stamp at) const;
  [[nodiscard]] double speed(Stamp at) const { return motion_.speed(at); }
  [[nodiscard]] double truth_arcsec(Stamp at) const { return motion_.truth(at) * resolution_arcsec_; }
  [[nodiscard]] bool is_moving(Stamp at) const { return motion_.still_from() > at; }
  [[nodiscard]] Stamp still_from() const { return motion_.still_from(); }
  [[nodiscard]] Stamp blocked_until() const { return blocked_until_; }

  /// When it runs into a mechanical stop, if it goes on like this; kNever when it does not.
  [[nodiscard]] Stamp next_stop_hit(Stamp from) const;

  void move(Stamp at, long target, const StepperRates& rates);
  void halt(Stamp at, const StepperRates& rates);

  /// Stands still at once, as at a mechanical stop or without power.
  void freeze(Stamp at);

  /// Stands still until `until`, whatever is commanded.
  void block(Stamp at, Stamp until);

  /// The motor has missed `steps`, or as many as the mechanical stops allow.
  void miss(Stamp at, double steps);

  /// Counts from 0 where it is.
  void lose_position(Stamp at);

  /// Goes to both limits and home within [at, at + duration] and counts from there. Returns when the limits
  /// are hit.
  std::vector<Stamp> reset(Stamp at, Stamp duration);

  /// As reset(), but it jams on the way from the first limit to the second and counts from there.
  std::vector<Stamp> jam(Stamp at, Stamp duration);

  void forget(Stamp before) { motion_.forget(before); }

 private:
  [[nodiscard]] double reset_way(Stamp at) const;

  double resolution_arcsec_;
  double hard_margin_;
  long min_;
  long max_;
  long target_ = 0;
  Stamp blocked_until_{};
  Trajectory motion_{0.0};
};

/// Why a command is refused, in the words of the unit; empty when it is obeyed. A refused command has no
/// effect.
using PtuRefusal = std::string;

/// An axis has run into a limit.
struct PtuLimitHit {
  Stamp at{};
  PtuAxisId axis = PtuAxisId::Pan;
};

/// A reset that has begun.
struct AxesReset {
  Stamp end{};
  std::vector<PtuLimitHit> hits;  ///< in the order of time
  PtuRefusal failure;             ///< what is said at the end instead of an answer
};

/// Both axes and what commands make them do; it knows nothing of how commands are spelled.
class PtuHead {
 public:
  /// At home, as after a reset. `settings` outlives it.
  PtuHead(const PtuSettings& settings, std::uint64_t seed);

  PtuMemory config;

  [[nodiscard]] StepperAxis& axis(PtuAxisId id) noexcept { return axes_[index_of(id)]; }
  [[nodiscard]] const StepperAxis& axis(PtuAxisId id) const noexcept { return axes_[index_of(id)]; }
  [[nodiscard]] PtuAxisConfig& parameters(PtuAxisId id) noexcept { return config.axes[index_of(id)]; }

  // Positions: stored in slaved mode until release(), without effect in velocity mode.
  [[nodiscard]] PtuRefusal set_position(PtuAxisId id, long target, Stamp now);
  [[nodiscard]] PtuRefusal check_position(PtuAxisId id, long target) const;
  void release(Stamp now);
  void set_execution(PtuExecution execution, Stamp now);

  // Speeds: signed in velocity mode.
  [[nodiscard]] PtuRefusal set_speed(PtuAxisId id, long speed, Stamp now);
  [[nodiscard]] PtuRefusal check_speed(PtuAxisId id, long speed) const;
  [[nodiscard]] long desired_speed(PtuAxisId id) const;
  [[nodiscard]] long current_speed(PtuAxisId id, Stamp now) const;
  void set_control(PtuControl control, Stamp now);

  [[nodiscard]] PtuRefusal set_acceleration(PtuAxisId id, long value, Stamp now);
  [[nodiscard]] PtuRefusal set_base_speed(PtuAxisId id, long value, Stamp now);
  [[nodiscard]] PtuRefusal set_upper_speed(PtuAxisId id, long value, Stamp now);
  [[nodiscard]] PtuRefusal set_lower_speed(PtuAxisId id, long value, Stamp now);

  void halt(PtuAxisId id, Stamp now);

  /// Pan runs to and fro until end_monitor(), which sends both axes home.
  void begin_monitor(Stamp now);
  void end_monitor(Stamp now);
  [[nodiscard]] bool is_monitoring() const noexcept { return monitor_end_.has_value(); }

  /// Resets the chosen axes, tilt first; a `jammed` one does not find its limits.
  [[nodiscard]] AxesReset begin_reset(PtuAxes axes, std::optional<PtuAxisId> jammed, Stamp now);
  void end_reset() { is_resetting_ = false; }

  /// Powerless, both axes stand where they are; afterwards they count from there.
  void cut_power(Stamp now);

  /// When an axis next runs into a stop or a scan turns; kNever for never.
  [[nodiscard]] Stamp next_event() const;

  /// Does what is due at `now`; reports an axis that has run into a stop, which then stands.
  std::optional<PtuLimitHit> step(Stamp now);

  [[nodiscard]] Stamp monitor_turn() const;
  [[nodiscard]] Stamp still_from() const;
  void forget(Stamp before);

 private:
  [[nodiscard]] PtuRefusal refuse(const std::string& pattern, PtuAxisId id, long value) const;
  [[nodiscard]] StepperRates rates(PtuAxisId id, long speed) const;
  [[nodiscard]] PtuRefusal refuse_in_motion(PtuAxisId id, Stamp now) const;
  [[nodiscard]] std::array<long, 2> bounds(PtuAxisId id) const;
  void run(PtuAxisId id, Stamp now);
  void go(PtuAxisId id, long target, Stamp now);
  void turn_monitor(Stamp now);

  const PtuSettings& settings_;
  std::array<StepperAxis, kPtuAxes> axes_;
  std::array<std::optional<long>, kPtuAxes> stored_;  // targets in slaved mode
  std::array<long, kPtuAxes> velocities_{};           // in velocity mode
  std::array<bool, kPtuAxes> is_lost_{};              // not reset since power-up, or in vain
  std::optional<std::size_t> monitor_end_;            // which end the scan goes to
  bool is_resetting_ = false;
  Stamp seen_{};  // the last moment heard of
};

}  // namespace slamsensor::tools
