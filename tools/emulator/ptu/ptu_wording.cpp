#include "tools/emulator/ptu/ptu_wording.hpp"

namespace slamsensor::tools {
namespace {

PtuWording oldest() {
  PtuWording wording;
  wording.version = "Pan-Tilt Controller v1.09.0b, (C)1996 Directed Perception, Inc., All Rights Reserved";
  wording.banner = "\r\n\r\n" + wording.version + "\r\nInitializing...";
  wording.desired_position = "Target %a position is %n";
  wording.desired_speed = "Target %a speed is %n positions/sec";
  wording.base_speed = "Base %a speed is %n positions/sec";
  wording.resolution = "%n seconds arc per position";
  return wording;
}

PtuWording e_series() {
  PtuWording wording;
  wording.version = "v3.3.0, (C)2010-2011 FLIR Commercial Systems, Inc., All Rights Reserved";
  wording.banner = "\r\n\r\n### PAN-TILT CONTROLLER\r\n### " + wording.version + "\r\nInitializing...";
  wording.environment_terse = "30.0,86,84,85";
  wording.desired_position = "Target %a position is %n";
  wording.desired_speed = "Target %a speed is %n positions/sec";
  wording.acceleration = "%a acceleration is %n positions/sec/sec";
  wording.resolution = "%n seconds arc per position";
  wording.independent = "Independent (default) speed control mode";
  wording.velocity = "Pure velocity speed control mode";
  wording.illegal_command = "Illegal Command Entered";
  return wording;
}

}  // namespace

PtuWording ptu_wording(PtuFirmware firmware) {
  switch (firmware) {
    case PtuFirmware::Dp109:
      return oldest();
    case PtuFirmware::FlirE33:
      return e_series();
    case PtuFirmware::Dp212:
      break;
  }
  return {};
}

std::string worded(std::string_view pattern, std::string_view axis, std::string_view value) {
  std::string text;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const std::string_view mark = pattern.substr(i, 2);
    if (mark == "%a" || mark == "%n") {
      text += mark == "%a" ? axis : value;
      ++i;
    } else {
      text += pattern[i];
    }
  }
  return text;
}

}  // namespace slamsensor::tools
