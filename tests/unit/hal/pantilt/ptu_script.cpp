#include "tests/unit/hal/pantilt/ptu_script.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <utility>

namespace slamsensor::tests {
namespace {

using hal::Stamp;

constexpr std::string_view kVersion =
    "Pan-Tilt Controller v2.12.1d1(C14/E), (C)2003 Directed Perception, Inc., All Rights Reserved";

std::string sentence_of(const std::string& command, const std::string& value) {
  const std::string axis = command[0] == 'P' ? "Pan" : "Tilt";
  switch (command[1]) {
    case 'P':
      return "Current " + axis + " position is " + value;
    case 'N':
      return "Minimum " + axis + " position is " + value;
    case 'X':
      return "Maximum " + axis + " position is " + value;
    case 'R':
      return value + " seconds arc per " + axis + " position";
    case 'U':
      return "Maximum " + axis + " speed is " + value + " positions/sec";
    case 'L':
      return "Minimum " + axis + " speed is " + value + " positions/sec";
    case 'B':
      return "Current " + axis + " base speed is " + value + " positions/sec";
    case 'A':
      return axis + " acceleration is " + value + " positions/sec^2";
    default:
      return "Desired " + axis + " speed is " + value + " positions/sec";
  }
}

bool takes_rate(const std::string& command) {
  constexpr std::array<int, 9> kRates{600, 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
  return std::find(kRates.begin(), kRates.end(), std::atoi(command.c_str() + 2)) != kRates.end();
}

}  // namespace

PtuScript::PtuScript(ScriptedLink& link) : link_(link) {
  facts = {{"PR", "185.1428"}, {"PN", "-3090"}, {"PX", "3090"},     {"PU", "2902"}, {"PL", "31"},
           {"PB", "1000"},     {"PA", "2000"},  {"TR", "185.1428"}, {"TN", "-907"}, {"TX", "604"},
           {"TU", "2902"},     {"TL", "31"},    {"TB", "1000"},     {"TA", "2000"}};
  place('P', 0);
  place('T', 0);
}

int PtuScript::position(char axis, Stamp at) const {
  const Motion& motion = axes_.at(axis);
  if (!motion.moving) {
    return motion.rest;
  }
  const double way = motion.profile.position_rad(hal::to_seconds(at - motion.begun) / (1.0 + slowness));
  return static_cast<int>(way);
}

void PtuScript::run(char axis, int target, double speed, Stamp at) {
  Motion& motion = axes_[axis];
  if (motion.moving && motion.target == target &&
      motion.profile.duration_s() > hal::to_seconds(at - motion.begun)) {
    return;  // under way already
  }
  const int from = position(axis, at);
  motion = {from, from, target, motion.speed, true, {}, at + move_latency};
  motion.profile = hal::MotionProfile(from, target, speed, ramp);
}

void PtuScript::power_cycle(Stamp at, Stamp reset) {
  echo = true;
  verbose = true;
  typed.clear();
  axes_.clear();
  place('P', 0);
  place('T', 0);
  baud = 9600;
  mute_until = at + reset;
  free_ = at;
  say("\r\n\r\n### PAN-TILT CONTROLLER\r\n### v3.3.0, (C)2010-2011 FLIR Commercial Systems, Inc., All Rights "
      "Reserved\r\nInitializing...",
      at);
  say("!T!T!P!P*\r\n", at + reset);
}

void PtuScript::say(std::string_view text, Stamp at) {
  std::string out(text);
  if (link_.baud() != baud) {
    std::transform(out.begin(), out.end(), out.begin(),
                   [](char c) { return static_cast<char>(c * 37 | 0x81); });
  }
  free_ = std::max(free_, at);
  link_.deliver(out, free_, baud);
  free_ += hal::line_time(out.size(), baud);
}

void PtuScript::on_write(const ScriptedLink::Written& written) {
  for (std::size_t i = 0; i < written.text.size(); ++i) {
    const Stamp at = written.at + hal::line_time(i + 1, written.baud);
    if (written.baud != baud) {
      continue;
    }
    const char c = written.text[i];
    if (monitor) {
      monitor = false;
      run('P', 0, 1000.0, at);
    }
    if (at < mute_until) {
      continue;
    }
    if (c != ' ' && c != '\r' && c != '\n') {
      typed += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      continue;
    }
    if (echo) {
      say(typed + echo_end, at);
    }
    if (!typed.empty()) {
      const std::string command = std::exchange(typed, {});
      on_command(command, at);
    }
  }
}

void PtuScript::on_command(const std::string& command, Stamp at) {
  heard.push_back(command);
  Stamp when = at + latency;
  std::string reply = result_of(command, when) + eol;
  const auto mishap = std::find_if(mishaps.begin(), mishaps.end(), [&](const Mishap& m) {
    return m.command == command ||
           (m.command.back() == '?' && command.starts_with(m.command.substr(0, m.command.size() - 1)));
  });
  if (mishap != mishaps.end()) {
    reply = mishap->twist ? mishap->twist(reply) : reply;
    when += mishap->late;
    mishaps.erase(mishap);
  }
  reply = twist ? twist(reply) : reply;
  if (swaps && !held_) {
    held_ = reply;
  } else {
    say(reply + std::exchange(held_, std::nullopt).value_or(""), when + late);
  }
  if (command.starts_with("@(") && obeys_baud && reply[0] == '*') {
    baud = static_cast<std::uint32_t>(std::atoi(command.c_str() + 2));
  }
}

int PtuScript::count(const std::string& command) const {
  return static_cast<int>(std::count(heard.begin(), heard.end(), command));
}

std::string PtuScript::result_of(const std::string& command, Stamp at) {
  if (command == "V") {
    return "* " + std::string(kVersion);
  }
  if (facts.contains(command)) {
    return "* " + (verbose ? sentence_of(command, facts[command]) : facts[command]);
  }
  if (command.size() >= 2 && (command[0] == 'P' || command[0] == 'T') &&
      (command[1] == 'P' || command[1] == 'S')) {
    return position_result(command, at);
  }
  return setting_result(command, at);
}

std::string PtuScript::position_result(const std::string& command, Stamp at) {
  const char axis = command[0];
  if (command.size() == 2) {
    const std::string value =
        std::to_string(command[1] == 'P' ? position(axis, at) : static_cast<int>(axes_[axis].speed));
    return "* " + (verbose ? sentence_of(command, value) : value);
  }
  const int value = std::atoi(command.c_str() + 2);
  if (command[1] == 'S') {
    axes_[axis].speed = value;
    return "*";
  }
  const int maximum = std::atoi(facts[std::string(1, axis) + "X"].c_str());
  if (value > maximum) {
    return "! Maximum allowable Pan position is " + std::to_string(maximum);
  }
  if (!slaved && !velocity) {
    run(axis, value, axes_[axis].speed, at);
  }
  return "*";
}

std::string PtuScript::setting_result(const std::string& command, Stamp at) {
  if (command == "ED") {
    echo = keeps_echo;
  } else if (command == "FT") {
    verbose = keeps_sentences;
  } else if (command == "CI") {
    velocity = false;
  } else if (command == "I") {
    slaved = false;
  } else if (command == "LE") {
    limits = true;
  } else if (command == "H") {
    for (auto& [axis, motion] : axes_) {
      motion.rest = position(axis, at);
      motion.moving = false;
    }
  } else if (command == "R") {
    place('P', 0);
    place('T', 0);
    return "!T!T!P!P*";
  } else if (!command.starts_with("@(") || !takes_rate(command)) {
    return "! Illegal argument";
  }
  return "*";
}

}  // namespace slamsensor::tests
