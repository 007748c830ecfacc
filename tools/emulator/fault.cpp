#include "tools/emulator/fault.hpp"

#include <array>

namespace slamsensor::tools {

std::string_view name_of(FaultKind kind) noexcept {
  constexpr std::array<std::string_view, kFaultKinds> kNames = {
      "drop_byte",      "corrupt_byte",  "double_byte",  "noise",         "stall",         "cable_out",
      "power_cycle",    "silence",       "baud_reset",   "swallow_reply", "double_reply",  "late_reply",
      "limit_report",   "reset_error",   "missed_steps", "monitor_mode",  "settings_lost", "no_returns",
      "weak_signal",    "saturation",    "bad_checksum", "stream_stops",  "text_message",  "device_error",
      "interface_down", "bus_off",       "lost_frame",   "emergency",     "sdo_abort",     "sdo_silence",
      "node_reset",     "heartbeat_lost"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace slamsensor::tools
