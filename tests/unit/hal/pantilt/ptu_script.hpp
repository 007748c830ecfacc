#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "tests/support/scripted_link.hpp"

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tests {

/// The unit of a test: what the manual says a PTU-46-17.5 answers, command by command, and whatever a test
/// wants to go wrong.
class PtuScript {
 public:
  /// What happens to the reply of one command.
  struct Mishap {
    std::string command;                            ///< the whole command, or its verb with a '?' for "any"
    std::function<std::string(std::string)> twist;  ///< of the reply text with its end of line
    hal::Stamp late{};
  };

  explicit PtuScript(ScriptedLink& link);

  void on_write(const ScriptedLink::Written& written);

  /// Sends `text` now, as the unit does by itself.
  void say(std::string_view text, hal::Stamp at);

  /// Position of an axis ('P', 'T') at `at`.
  [[nodiscard]] int position(char axis, hal::Stamp at) const;
  void place(char axis, int position) { axes_[axis] = {}, axes_[axis].rest = position; }
  void run(char axis, int target, double speed, hal::Stamp at);
  void power_cycle(hal::Stamp at, hal::Stamp reset);

  std::uint32_t baud = 9600;
  bool echo = true;
  bool verbose = true;
  bool velocity = false;
  bool slaved = false;
  bool limits = false;
  bool monitor = false;
  bool obeys_baud = true;
  char echo_end = ' ';
  bool keeps_echo = false;                 ///< whatever ED says
  bool keeps_sentences = false;            ///< whatever FT says
  hal::AxisDynamics ramp{1000.0, 2000.0};  ///< of both axes in truth, whatever `facts` tell
  double slowness = 0.0;                   ///< share by which its clock is slow
  hal::Stamp late{};                       ///< of every reply, beside its latency
  bool swaps = false;                      ///< each reply waits for the next one, which goes out before it
  std::function<std::string(std::string)> twist;  ///< of every reply
  std::string eol = "\r\n";
  std::string typed;  ///< half a command
  hal::Stamp mute_until{};
  hal::Stamp latency = std::chrono::milliseconds(3);
  hal::Stamp move_latency{};
  std::map<std::string, std::string> facts;  ///< terse results of queries
  std::deque<Mishap> mishaps;
  std::vector<std::string> heard;  ///< commands, in order

  [[nodiscard]] int count(const std::string& command) const;

 private:
  struct Motion {
    int rest = 0;
    int from = 0;
    int target = 0;
    double speed = 2000.0;
    bool moving = false;
    hal::MotionProfile profile;
    hal::Stamp begun{};
  };

  void on_command(const std::string& command, hal::Stamp at);
  [[nodiscard]] std::string result_of(const std::string& command, hal::Stamp at);
  [[nodiscard]] std::string position_result(const std::string& command, hal::Stamp at);
  [[nodiscard]] std::string setting_result(const std::string& command, hal::Stamp at);

  ScriptedLink& link_;
  std::map<char, Motion> axes_;
  hal::Stamp free_{};                // of the line to the driver
  std::optional<std::string> held_;  // back, to be swapped
};

}  // namespace slamsensor::tests
