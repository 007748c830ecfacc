#pragma once

#include "tools/emulator/canopen/drive_axis.hpp"

#include <cstdint>
#include <optional>

namespace slamsensor::tools {

/// CiA 402, power drive system state machine.
enum class PowerState : std::uint8_t {
  NotReady,
  SwitchOnDisabled,
  ReadyToSwitchOn,
  SwitchedOn,
  OperationEnabled,
  QuickStopActive,
  FaultReaction,
  Fault,
};

/// What a drive reports in an emergency message.
struct DriveError {
  std::uint16_t code = 0;  ///< 0: the error is gone
  std::uint8_t error_register = 0;
};

/// A CiA 402 drive without its bus: states, profile position, profile velocity and homing, limits, halt,
/// quick stop, faults. It takes parameters from the node's objects when a motion begins.
class DriveControl {
 public:
  /// All outlive it.
  DriveControl(const DriveSettings& settings, const ObjectDictionary& objects, DriveAxis& axis)
      : settings_(settings),
        objects_(objects),
        axis_(axis),
        knows_zero_(settings.memory == DriveMemory::Absolute) {}

  /// As after power-up or a reset of the node: switch-on disabled, no mode, the axis stands.
  void start(Stamp now);

  /// No power: the axis stands.
  void cut(Stamp now);

  // A host has written the object of this name.
  void set_controlword(std::uint16_t word, Stamp now);
  void set_mode(std::int8_t mode, Stamp now);
  void set_target_velocity(Stamp now);

  /// An error with `code` and its bit in the error register; no reset until `held_until`.
  void fail(const DriveError& error, Stamp now, Stamp held_until);

  /// Something holds the axis: once it lags too much it fails.
  void jam(Stamp now);

  /// When something happens by itself; and what is due at `now` happens.
  [[nodiscard]] Stamp next_event() const;
  void step(Stamp now);

  /// The word as at `now`.
  [[nodiscard]] std::uint16_t statusword(Stamp now) const;
  [[nodiscard]] std::int8_t mode() const noexcept { return mode_; }
  [[nodiscard]] PowerState state() const noexcept { return state_; }
  [[nodiscard]] const DriveError& error() const noexcept { return error_; }

  /// The error that came or went since the last call.
  [[nodiscard]] std::optional<DriveError> take_report();

 private:
  enum class Homing : std::uint8_t { Idle, Running, Done, Failed };  // since the mode was set
  struct SetPoint {
    double target = 0.0;
    DriveRates rates;
  };

  void change_state(std::uint16_t word, Stamp now);
  void leave_power(PowerState state, Stamp now);
  void enable(Stamp now);
  void ramp_to(PowerState state, std::int64_t deceleration, Stamp now);
  void quick_stop(Stamp now);
  void obey_mode(std::uint16_t word, std::uint16_t rising, Stamp now);
  void halt(Stamp now);
  void go_on(Stamp now);
  void take_set_point(std::uint16_t word, Stamp now);
  void begin_set_point(const SetPoint& point, Stamp now);
  void watch_limit(Stamp now);
  void begin_homing(Stamp now);
  void end_homing(Stamp now);
  [[nodiscard]] double bounded(double target);
  [[nodiscard]] DriveRates rates(std::int64_t speed) const;
  [[nodiscard]] std::uint16_t mode_bits(Stamp now) const;
  [[nodiscard]] bool is_ready(Stamp now) const { return axis_.settled_at() <= now; }
  [[nodiscard]] double number(ObjectKey key) const { return static_cast<double>(objects_.value(key)); }

  const DriveSettings& settings_;
  const ObjectDictionary& objects_;
  DriveAxis& axis_;
  PowerState state_ = PowerState::NotReady;
  std::optional<PowerState> next_state_;  // when the axis stands
  std::uint16_t word_ = 0;
  std::int8_t mode_ = 0;
  DriveError error_;
  std::optional<DriveError> report_;
  Stamp held_until_{};
  Stamp jammed_at_ = hal::kNever;  // the time at which it fails
  bool is_jammed_ = false;

  std::optional<SetPoint> running_;
  std::optional<SetPoint> buffered_;
  double last_target_ = 0.0;
  bool is_acknowledged_ = false;  // bit 12 of profile position
  bool is_limited_ = false;       // bit 11
  Homing homing_ = Homing::Idle;
  bool knows_zero_;
  Stamp step_at_ = hal::kNever;  // the end of the present motion, until seen
};

}  // namespace slamsensor::tools
