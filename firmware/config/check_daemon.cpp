#include "firmware/config/rules.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace slamsensor::firmware {
namespace {

void check_realtime(Rules& rules) {
  const RealtimeConfig& realtime = rules.config().daemon.realtime;
  rules.require(realtime.slam_priority < realtime.scan_priority,
                {"realtime.slam_priority", "realtime.scan_priority"}, "is not below");
  rules.require(realtime.scan_deadline_s >= realtime.scan_period_s,
                {"realtime.scan_deadline_s", "realtime.scan_period_s"}, "is below");
}

/// A sentence has at most 82 characters of 10 bits.
void check_nmea(Rules& rules) {
  constexpr double kSentenceBits = 820.0;
  const Config& config = rules.config();
  const NmeaSentences& chosen = config.nmea.sentences;
  const int sentences =
      chosen.rmc + chosen.gga + chosen.gbs + chosen.hdt + chosen.ths + chosen.gst + chosen.pslma;
  const double needed = kSentenceBits * sentences * config.daemon.nmea_rate_hz;
  rules.require(config.daemon.nmea_serial.path.empty() || needed <= config.daemon.nmea_serial.baud,
                {"nmea.rate_hz", "nmea.serial_baud", "nmea.sentences"},
                "needs up to " + real_text(needed) + " bits per second, more than the line carries:");
}

void check_lcm(Rules& rules) {
  const LcmConfig& lcm = rules.config().daemon.lcm;
  bool is_own = false;
  for (const std::string_view channel : {"POSE", "STATUS", "COUNTERS", "MAP", "SCAN"}) {
    is_own = is_own || lcm.bot_core_channel == lcm.prefix + std::string(channel);
  }
  rules.require(!is_own, {"lcm.bot_core_channel", "lcm.prefix"},
                "is one of the sensor's own channels, made of");
}

struct GpioUse {
  std::string_view chip_key;
  std::string_view line_key;
  const std::string& chip;
  std::uint32_t line;
};

void check_gpio(Rules& rules) {
  const GpioConfig& gpio = rules.config().daemon.gpio;
  const std::array<GpioUse, 4> uses = {
      {{"gpio.trigger_chip", "gpio.trigger_line", gpio.trigger.chip, gpio.trigger.line},
       {"gpio.interlock_chip", "gpio.interlock_line", gpio.interlock.chip, gpio.interlock.line},
       {"gpio.led_chip", "gpio.led_line", gpio.led.chip, gpio.led.line},
       {"gpio.pulse_chip", "gpio.pulse_line", gpio.pulse.chip, gpio.pulse.line}}};
  for (std::size_t i = 0; i < uses.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool is_same =
          !uses[i].chip.empty() && uses[i].chip == uses[j].chip && uses[i].line == uses[j].line;
      rules.require(!is_same, {uses[i].line_key, uses[j].line_key, uses[i].chip_key},
                    "is a line that is used twice:");
    }
  }
}

}  // namespace

void check_daemon(Rules& rules) {
  check_realtime(rules);
  check_nmea(rules);
  check_lcm(rules);
  check_gpio(rules);
}

}  // namespace slamsensor::firmware
