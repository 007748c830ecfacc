#pragma once

#include "hal/counters.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace slamsensor::hal {

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
  PositionsImplausible,  ///< reported positions that were not believed
  PositionsUnproven,     ///< plausible, but on a way the driver cannot predict, and so not delivered
  PositionsDropped,      ///< nobody took them
  PositionsRevoked,      ///< the line was disturbed right after them
  MovesRefused,          ///< by the driver: not ready, busy, out of range
  MovesRejected,         ///< by the unit
  MovesRepeated,         ///< sent again because no confirmation came
  MovesLost,             ///< confirmed, but the axis did not do it
};

inline constexpr std::array<std::string_view, 25> kPtuEventNames{
    "replies_late",       "replies_unexpected", "replies_garbled",
    "lines_overlong",     "limit_reports",      "trigger_reports",
    "cable_reports",      "timeouts",           "resyncs",
    "restarts",           "power_cycles",       "baud_fallbacks",
    "network_recoveries", "resets_failed",      "facts_refused",
    "settings_refused",   "settings_restored",  "positions_implausible",
    "positions_unproven", "positions_dropped",  "positions_revoked",
    "moves_refused",      "moves_rejected",     "moves_repeated",
    "moves_lost"};

using PtuCounters = Counters<PtuEvent, kPtuEventNames.size()>;

}  // namespace slamsensor::hal
