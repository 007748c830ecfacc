#pragma once

#include "hal/counters.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace slamsensor::hal {

/// What a CANopen pan-tilt driver counts, in the order of kCanopenEventNames.
enum class CanopenEvent : std::uint8_t {
  FramesMalformed,    ///< of this unit, with a length or a content it cannot have
  SdoRepliesForeign,  ///< to a request given up, or to none
  SdoAborts,          ///< requests the node refused
  SdoTimeouts,        ///< requests without an answer in time
  SdoRepeats,         ///< requests sent again
  SendsBusy,          ///< frames that waited because the bus had no room
  SyncsLate,          ///< SYNC sent more than a period late
  HeartbeatsLost,     ///< times a heartbeat stayed away
  BootUps,            ///< a node in use started anew
  Emergencies,        ///< EMCY messages that tell an error
  Faults,             ///< a drive in use fell into its fault state
  StatesLost,         ///< a node or drive in use left its operating state
  Restarts,           ///< start-ups of a node after its first
  SettingsRefused,    ///< optional objects and settings a node does not have
  MappingsFixed,      ///< PDOs whose map could not be set
  PositionsSilent,    ///< times positions stayed away
  PositionsUnpaired,  ///< more than one position for a SYNC, or one before any
  PositionsDropped,   ///< nobody took them
  MovesRefused,       ///< by the driver: not ready, busy, out of range
  MovesRejected,      ///< by the node
  MovesRepeated,      ///< sent again because the set-point was not acknowledged
  MovesLost,          ///< given up without an acknowledgement, or ended elsewhere
};

inline constexpr std::array<std::string_view, 22> kCanopenEventNames{
    "frames_malformed", "sdo_replies_foreign", "sdo_aborts",        "sdo_timeouts",     "sdo_repeats",
    "sends_busy",       "syncs_late",          "heartbeats_lost",   "boot_ups",         "emergencies",
    "faults",           "states_lost",         "restarts",          "settings_refused", "mappings_fixed",
    "positions_silent", "positions_unpaired",  "positions_dropped", "moves_refused",    "moves_rejected",
    "moves_repeated",   "moves_lost"};

using CanopenCounters = Counters<CanopenEvent, kCanopenEventNames.size()>;

}  // namespace slamsensor::hal
