#pragma once

#include "tools/emulator/rangefinder/outbox.hpp"
#include "tools/emulator/rangefinder/power_switch.hpp"
#include "tools/emulator/rangefinder/shot_timer.hpp"
#include "tools/emulator/rangefinder/sight.hpp"

namespace slamsensor::tools {

/// What is the same in every emulated rangefinder: power, the clock of its shots, what waits for its line,
/// the faults under way, a restart to come.
struct LaserMachine {
  /// `settings` are those of any rangefinder; `line` and `scene` outlive this.
  template <typename Settings>
  LaserMachine(const Settings& settings, OutboxLine& line, RangeScene& scene)
      : outbox(line, scene, settings.delays, settings.seed),
        power(settings.begin, settings.boot_time),
        timer(settings.crystal_ppm) {}

  [[nodiscard]] Stamp next_event() const;

  /// Whether a shot is due at `now`; the next one is then a period later.
  [[nodiscard]] bool takes_shot(Stamp now);

  /// What is due goes out, unless a fault keeps it silent.
  void release(Stamp now);

  /// Without power before `until`: nothing waits any more, nothing is shot.
  void go_down(Stamp until);

  /// Takes a fault of what is seen, or of the voice; false for others.
  bool open(const Fault& fault);

  Outbox outbox;
  FaultWindows faults;
  PowerSwitch power;
  ShotTimer timer;
  Stamp restart_at = hal::kNever;
};

}  // namespace slamsensor::tools
