#pragma once

#include "tools/emulator/ptu/ptu_axis.hpp"
#include "tools/world/random.hpp"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// Codes of the binary interface.
enum class PtuStatus : std::uint8_t {
  Ok = 0,
  IllegalCommand = 2,
  IllegalPosition = 3,
  IllegalSpeed = 4,
  AccelerationTable = 5,
  LimitHit = 8,
  IllegalUnitId = 10,
  IllegalPower = 11,
  ResetFailed = 12,
  NotSupported = 17,
  Checksum = 20,
};

/// Whether a command was obeyed; if not, why, as a code and in words. A refused command has no effect.
struct PtuVerdict {
  PtuStatus status = PtuStatus::Ok;
  std::string error;
};

/// An axis has run into a limit.
struct PtuLimitHit {
  Stamp at{};
  PtuAxisId axis = PtuAxisId::Pan;
};

/// A reset that has begun.
struct PtuReset {
  Stamp end{};
  std::vector<PtuLimitHit> hits;  ///< in the order of time
  PtuVerdict verdict;             ///< as it will be at the end
};

/// Both axes and what commands make them do; it knows nothing of how commands are spelled.
class PtuHead {
 public:
  /// At home, as after a reset. `settings` outlives it.
  PtuHead(const PtuSettings& settings, std::uint64_t seed);

  PtuConfig config;

  [[nodiscard]] PtuAxis& axis(PtuAxisId id) noexcept { return axes_[index_of(id)]; }
  [[nodiscard]] const PtuAxis& axis(PtuAxisId id) const noexcept { return axes_[index_of(id)]; }
  [[nodiscard]] PtuAxisConfig& parameters(PtuAxisId id) noexcept { return config.axes[index_of(id)]; }

  // Positions: stored in slaved mode until release(), without effect in velocity mode.
  [[nodiscard]] PtuVerdict set_position(PtuAxisId id, long target, Stamp now);
  [[nodiscard]] PtuVerdict check_position(PtuAxisId id, long target) const;
  void release(Stamp now);
  void set_execution(PtuExecution execution, Stamp now);

  // Speeds: signed in velocity mode.
  [[nodiscard]] PtuVerdict set_speed(PtuAxisId id, long speed, Stamp now);
  [[nodiscard]] PtuVerdict check_speed(PtuAxisId id, long speed) const;
  [[nodiscard]] long desired_speed(PtuAxisId id) const;
  [[nodiscard]] long current_speed(PtuAxisId id, Stamp now) const;
  void set_control(PtuControl control, Stamp now);

  [[nodiscard]] PtuVerdict set_acceleration(PtuAxisId id, long value, Stamp now);
  [[nodiscard]] PtuVerdict set_base_speed(PtuAxisId id, long value, Stamp now);
  [[nodiscard]] PtuVerdict set_upper_speed(PtuAxisId id, long value, Stamp now);
  [[nodiscard]] PtuVerdict set_lower_speed(PtuAxisId id, long value, Stamp now);

  /// Pan and tilt target, pan and tilt speed, all or nothing.
  [[nodiscard]] PtuVerdict set_motion(const std::array<long, 2 * kPtuAxes>& values, Stamp now);

  void halt(PtuAxisId id, Stamp now);

  void save_preset(long number, Stamp now);
  [[nodiscard]] PtuVerdict go_to_preset(long number, Stamp now);
  void clear_presets() { presets_.clear(); }

  /// Both axes run to and fro until end_monitor(), which sends them home.
  void begin_monitor(Stamp now);
  void end_monitor(Stamp now);
  [[nodiscard]] bool is_monitoring() const noexcept { return monitor_end_.has_value(); }

  /// Resets the chosen axes, tilt first; a `jammed` one does not find its limits.
  [[nodiscard]] PtuReset begin_reset(PtuAxes axes, std::optional<PtuAxisId> jammed, Stamp now);
  void end_reset();

  /// Powerless, both axes stand where they are; afterwards they count from there.
  void cut_power(Stamp now);

  /// When an axis next runs into a stop or a scan turns; kNever for never.
  [[nodiscard]] Stamp next_event() const;

  /// Does what is due at `now`; tells of an axis that has run into a stop, which then stands.
  std::optional<PtuLimitHit> step(Stamp now);

  [[nodiscard]] Stamp still_from() const;
  void forget(Stamp before);

 private:
  [[nodiscard]] PtuVerdict refuse(PtuStatus status, const std::string& pattern, PtuAxisId id,
                                  long value) const;
  [[nodiscard]] StepperRates rates(PtuAxisId id, long speed) const;
  [[nodiscard]] std::optional<PtuVerdict> refuse_in_motion(PtuAxisId id, Stamp now) const;
  [[nodiscard]] std::array<long, 2> bounds(PtuAxisId id) const;
  void run(PtuAxisId id, Stamp now);
  void go(PtuAxisId id, long target, Stamp now);
  void turn_monitor(Stamp now);
  [[nodiscard]] Stamp reset_duration(PtuAxisId id, Stamp now) const;

  const PtuSettings& settings_;
  std::array<PtuAxis, kPtuAxes> axes_;
  std::array<std::optional<long>, kPtuAxes> stored_;  // targets in slaved mode
  std::array<long, kPtuAxes> velocities_{};           // in velocity mode
  std::array<bool, kPtuAxes> is_lost_{};              // not reset since power-up, or in vain
  std::map<long, std::array<long, kPtuAxes>> presets_;
  std::optional<std::size_t> monitor_end_;  // which end the scan goes to
  bool is_resetting_ = false;
  Stamp seen_{};  // the last moment heard of
};

}  // namespace slamsensor::tools
