#pragma once

#include "hal/counters.hpp"
#include "hal/init_error.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace slamsensor::hal {

/// When a start-up sends `R`, which drives both axes into their stops to find the zero.
enum class PtuReset : std::uint8_t {
  Never,
  IfUnreferenced,  ///< the unit reports impossible limits, stands outside them, or refuses a move with "Axis
                   ///< Error"
  Always,          ///< at every start-up
};

/// Which way an axis counts: Normal is pan positive to the left and tilt positive upwards.
enum class PtuSense : std::uint8_t { Normal, Reversed };

/// What to do about a unit that is silent because it was left with a network identity.
enum class PtuNetworkRecovery : std::uint8_t {
  Never,
  /// Once in the life of the driver, when no rate has an answer: select every unit, set identity 0, save,
  /// reset. Saving writes the unit's EEPROM, whose write life is limited.
  WritesEeprom,
};

/// Whether bytes take their time on the line. A bridge over a network or a unit on USB delivers them at once;
/// stamps then do not reckon with line time.
enum class PtuPacing : std::uint8_t { LineRate, AtOnce };

/// How to talk to a Directed Perception / FLIR pan-tilt unit. Limits, resolution and speeds are not here: the
/// unit is always asked.
struct PtuConfig {
  std::vector<std::uint32_t> rates_baud{9600, 38400, 19200, 57600, 115200};  ///< tried in this order, 1..8
  std::uint32_t fast_baud = 0;  ///< changed to after start-up, not saved in the unit; 0: stay

  PtuReset reset = PtuReset::IfUnreferenced;
  PtuPacing pacing = PtuPacing::LineRate;
  PtuSense pan_sense = PtuSense::Normal;
  PtuSense tilt_sense = PtuSense::Normal;
  PtuNetworkRecovery network_recovery = PtuNetworkRecovery::Never;

  double poll_hz = 40.0;      ///< of a moving axis, 1..200; the line may allow less
  double rest_poll_hz = 2.0;  ///< of a resting axis, 0.1..poll_hz

  /// Time-outs, from the last byte of the command, on top of what the reply takes on the line.
  Stamp query_timeout = std::chrono::milliseconds(200);
  Stamp motion_timeout = std::chrono::milliseconds(500);
  Stamp mode_timeout = std::chrono::milliseconds(400);
  Stamp reset_timeout = std::chrono::seconds(60);  ///< also how long a unit found resetting is waited for

  Stamp wake_wait = std::chrono::milliseconds(300);  ///< after the characters that end a monitor scan
  Stamp drain = std::chrono::milliseconds(50);       ///< silence that ends what an error left on the line
  Stamp baud_wait = std::chrono::milliseconds(100);  ///< from the change of rate to the first byte at it
  Stamp retry_wait = std::chrono::seconds(5);        ///< of a faulted unit

  Stamp move_latency_max =
      std::chrono::milliseconds(150);  ///< from command to motion, else it is disbelieved
  /// What an axis may be off its profile in time, beyond what stamps allow. A unit that reckons its motion
  /// in ticks needs as much as one tick.
  Stamp stamp_slack = std::chrono::milliseconds(2);
  /// Positions of a moving axis that are less sure in time are not delivered.
  Stamp half_width_max = std::chrono::milliseconds(50);
};

/// Which figure of `config` is out of its bounds; nothing when all are within.
[[nodiscard]] std::optional<InitError> ptu_config_error(const PtuConfig& config);

/// What a PTU driver counts, in the order of kPtuEventNames.
enum class PtuEvent : std::uint8_t {
  RepliesLate,           ///< recognised as belonging to a command given up, and dropped
  RepliesUnexpected,     ///< nothing was asked, or something else was
  RepliesGarbled,        ///< lines without the grammar of a reply
  LinesOverlong,         ///< lines longer than any reply, dropped
  LimitReports,          ///< !P !T
  TriggerReports,        ///< #P #T $P $T
  CableReports,          ///< !D
  Timeouts,              ///< commands without an answer
  Resyncs,               ///< drains with a marker query after them
  Restarts,              ///< start-ups after the first
  PowerCycles,           ///< banners seen
  BaudFallbacks,         ///< the faster rate was not taken
  NetworkRecoveries,     ///< recovery lines sent (each writes the EEPROM)
  ResetsFailed,          ///< reset answered with an error, or not at all
  FactsRefused,          ///< limits, resolution or speeds that cannot be
  SettingsRefused,       ///< optional settings the unit does not know
  SettingsRestored,      ///< echo or verbose mode found on again and turned off
  EchoesStripped,        ///< commands that came back in front of their replies
  ProfilesLearnt,        ///< an axis was seen to speed up otherwise than it tells
  PositionsImplausible,  ///< reported positions that were not believed
  PositionsUnproven,     ///< plausible, but on a way the driver cannot predict, and so not delivered
  PositionsDropped,      ///< nobody took them
  PositionsRevoked,      ///< the line was disturbed right after them
  MovesRefused,          ///< by the driver: not ready, busy, out of range
  MovesRejected,         ///< by the unit
  MovesRepeated,         ///< sent again because no confirmation came
  MovesLost,             ///< confirmed, but the axis did not do it
};

inline constexpr std::array<std::string_view, 27> kPtuEventNames{"replies_late",
                                                                 "replies_unexpected",
                                                                 "replies_garbled",
                                                                 "lines_overlong",
                                                                 "limit_reports",
                                                                 "trigger_reports",
                                                                 "cable_reports",
                                                                 "timeouts",
                                                                 "resyncs",
                                                                 "restarts",
                                                                 "power_cycles",
                                                                 "baud_fallbacks",
                                                                 "network_recoveries",
                                                                 "resets_failed",
                                                                 "facts_refused",
                                                                 "settings_refused",
                                                                 "settings_restored",
                                                                 "echoes_stripped",
                                                                 "profiles_learnt",
                                                                 "positions_implausible",
                                                                 "positions_unproven",
                                                                 "positions_dropped",
                                                                 "positions_revoked",
                                                                 "moves_refused",
                                                                 "moves_rejected",
                                                                 "moves_repeated",
                                                                 "moves_lost"};

using PtuCounters = EventCounters<PtuEvent, kPtuEventNames.size()>;

}  // namespace slamsensor::hal
