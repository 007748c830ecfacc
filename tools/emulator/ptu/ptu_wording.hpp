#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace slamsensor::tools {

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
  std::string environment = "Input 30 VDC @ 86 degF";
  std::string environment_terse = "Input 30 VDC @ 86 degF";
  std::string current_position = "Current %a position is %n";
  std::string desired_position = "Current %a position is %n";
  std::string min_position = "Minimum %a position is %n";
  std::string max_position = "Maximum %a position is %n";
  std::string min_user_position = "Minimum user %a position is %n";
  std::string max_user_position = "Maximum user %a position is %n";
  std::string desired_speed = "Desired %a speed is %n positions/sec";
  std::string current_speed = "Current %a speed is %n positions/sec";
  std::string acceleration = "%a acceleration is %n positions/sec^2";
  std::string base_speed = "Current %a base speed is %n positions/sec";
  std::string max_speed = "Maximum %a speed is %n positions/sec";
  std::string min_speed = "Minimum %a speed is %n positions/sec";
  std::string resolution = "%n seconds arc per %a position";
  std::string limits_on = "Limit bounds are ENABLED (soft limits enabled)";
  std::string limits_off = "Limit bounds are DISABLED (hard limits only: use care)";
  std::string limits_user = "Limit bounds are USER (user limits enabled)";
  std::string independent = "independent (default) speed control mode";
  std::string velocity = "pure velocity speed control mode";
  std::string immediate = "immediate command execution mode";
  std::string slaved = "slaved command execution mode";
  std::string echo_on = "Echoing ON";
  std::string echo_off = "Echoing OFF";
  std::string verbose = "ASCII verbose mode";
  std::string terse = "ASCII terse mode";
  std::string hold_power = "%a in %n hold power mode";
  std::string move_power = "%a in %n move power mode";
  std::string unit_id = "Unit ID is %n";
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

}  // namespace slamsensor::tools
