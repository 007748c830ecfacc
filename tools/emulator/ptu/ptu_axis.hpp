#pragma once

#include "tools/emulator/ptu/motion_plan.hpp"
#include "tools/emulator/ptu/ptu_config.hpp"
#include "tools/emulator/ptu/trajectory.hpp"

#include <vector>

namespace slamsensor::tools {

/// A stepper axis with its limits, where it is and where it goes. Positions in steps of the present
/// resolution.
class PtuAxis {
 public:
  /// Rests at home, with limits `min_offset` and `max_offset` beside the model's.
  PtuAxis(const PtuAxisModel& model, long hard_margin, long min_offset, long max_offset);

  [[nodiscard]] long min() const noexcept { return min_; }
  [[nodiscard]] long max() const noexcept { return max_; }
  [[nodiscard]] double resolution_arcsec() const noexcept { return model_.resolution_arcsec / fineness_; }

  /// Where the present motion ends, or the axis rests.
  [[nodiscard]] long target() const noexcept { return target_; }
  [[nodiscard]] long position(Stamp at) const;
  [[nodiscard]] double speed(Stamp at) const { return motion_.speed(at); }
  [[nodiscard]] double truth_arcsec(Stamp at, PtuSteps steps) const;
  [[nodiscard]] bool is_moving(Stamp at) const { return motion_.still_from() > at; }
  [[nodiscard]] Stamp still_from() const { return motion_.still_from(); }

  /// When it runs into a mechanical stop, if it goes on like this; kNever when it does not.
  [[nodiscard]] Stamp next_stop_hit(Stamp from) const;

  void move(Stamp at, long target, const StepperRates& rates);
  void halt(Stamp at, const StepperRates& rates);

  /// Stands still at once, as at a mechanical stop or without power.
  void freeze(Stamp at);

  /// The motor has missed `steps`, or as many as the mechanical stops allow.
  void miss(Stamp at, double steps);

  /// Counts from 0 where it is.
  void lose_position(Stamp at);

  /// How far the reset goes that begins at `at`.
  [[nodiscard]] double reset_way(Stamp at) const;

  /// Goes to both limits and home within [at, at + duration] and counts from there. Returns when the limits
  /// are hit.
  std::vector<Stamp> reset(Stamp at, Stamp duration);

  /// As reset(), but it jams on the way from the first limit to the second and counts from there.
  std::vector<Stamp> jam(Stamp at, Stamp duration);

  /// Counts in other steps from now on: full, half, quarter, eighth, automatic ('F', 'H', 'Q', 'E', 'A').
  /// The axis is at home.
  void set_step_mode(char step_mode);

  void forget(Stamp before) { motion_.forget(before); }

 private:
  PtuAxisModel model_;
  long hard_margin_;
  long min_offset_;
  long max_offset_;
  double fineness_ = 1.0;  // steps of now in a step of the model
  long min_ = 0;
  long max_ = 0;
  long target_ = 0;
  Trajectory motion_{0.0};
};

}  // namespace slamsensor::tools
