#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/ptu/ptu_model.hpp"
#include "tools/emulator/ptu/ptu_wording.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// Whether LF ends a command, as on newer firmware, or is passed over.
enum class PtuLineFeed : std::uint8_t { Delimits, Ignored };

/// Whether, with the echo off, an LF precedes the answer to a command that CR or LF ended.
enum class PtuLeadingLf : std::uint8_t { Never, AfterLine };

/// Whether the answer to a change of the line rate is still at the old rate.
enum class PtuBaudReply : std::uint8_t { OldRate, NewRate };

/// What RE, RP and RT do: choose the reset of the next power-up (D46 manual), or that and reset (E-series).
enum class PtuResetWords : std::uint8_t { Choose, ChooseAndReset };

/// What the query PO tells.
enum class PtuOffsetQuery : std::uint8_t { Desired, Current };

/// What becomes of commands while the unit calibrates itself after power-up.
enum class PtuStarting : std::uint8_t { Drops, Holds, Answers };

/// Whether !T and !P stand between banner and the '*' that ends the power-up reset.
enum class PtuStartReports : std::uint8_t { Silent, Told };

/// Whether acceleration, base speed and speed bounds can be set while the axis moves.
enum class PtuTablesInMotion : std::uint8_t { Refused, Obeyed };

/// Whether the motor points between its steps or only at them.
enum class PtuSteps : std::uint8_t { Smooth, Quantised };

/// How the unit is found when the emulation begins.
enum class PtuBegin : std::uint8_t { PowerUp, Ready };

/// How long the unit is deaf after a command that makes it compute its speed tables anew.
struct PtuTableTimes {
  Stamp acceleration = std::chrono::seconds(2);
  Stamp base = std::chrono::seconds(2);
  Stamp lower = std::chrono::milliseconds(6500);
  Stamp upper = std::chrono::seconds(300);
};

/// All that differs between units, firmware and what their manuals leave open.
struct PtuSettings {
  PtuModel model = ptu_model(PtuKind::D46_17_5);
  PtuWording wording;
  std::string line_end = "\r\n";  ///< of answers; "\r" in the manual
  PtuLineFeed line_feed = PtuLineFeed::Delimits;
  PtuLeadingLf leading_lf = PtuLeadingLf::Never;
  PtuBaudReply baud_reply = PtuBaudReply::OldRate;
  PtuResetWords reset_words = PtuResetWords::Choose;
  PtuOffsetQuery offset_query = PtuOffsetQuery::Desired;
  PtuStarting starting = PtuStarting::Drops;
  PtuStartReports start_reports = PtuStartReports::Told;
  PtuTablesInMotion tables_in_motion = PtuTablesInMotion::Refused;
  PtuSteps steps = PtuSteps::Smooth;
  PtuBegin begin = PtuBegin::PowerUp;
  std::uint32_t factory_baud = 9600;
  std::vector<std::uint32_t> bauds = {600, 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
  Delay reply_latency = {std::chrono::milliseconds(3), std::chrono::milliseconds(1)};
  Stamp position_latency{};                          ///< age of a position when its query is parsed
  Stamp boot_time = std::chrono::milliseconds(500);  ///< from power to banner
  Stamp reset_time = std::chrono::seconds(30);       ///< of both axes; one axis takes half of it
  PtuTableTimes table_times;
  long limit_spread = 1;              ///< units find their limits within this of the model's
  long hard_margin = 200;             ///< the mechanical stops lie this far outside the limits
  long missed_steps_max = 60;         ///< what an obstacle takes at most, and 5 at least
  long acceleration_read_back = 0;    ///< added to what PA tells (-1 was seen)
  int pan_sign = 1;                   ///< +1: positive positions are left (counter-clockwise seen from above)
  int tilt_sign = 1;                  ///< +1: positive positions are up
  std::size_t input_capacity = 100;   ///< bytes that wait for the unit; more are lost
  std::size_t output_capacity = 100;  ///< bytes that wait until a networked unit is selected; more are lost
};

/// The settings of a unit of `kind` with the firmware of its time.
[[nodiscard]] PtuSettings ptu_settings(PtuKind kind);

}  // namespace slamsensor::tools
