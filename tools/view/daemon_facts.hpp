#pragma once

#include "firmware/config/daemon_config.hpp"
#include "tools/view/sensor_story.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace slamsensor::tools {

/// What a daemon works with that its LCM messages do not say.
struct DaemonFacts {
  std::int64_t initialization = 0;       ///< as in its messages
  std::optional<firmware::Datum> datum;  ///< in force; none when the home map is not the one it was given for
  double stale_s = firmware::FixConfig().stale_s;  ///< fix.stale_s in force
};

/// Asks the daemon at `socket`, within seconds; none when it does not answer all of it.
[[nodiscard]] std::optional<DaemonFacts> ask_facts(const std::string& socket);

/// Gives the story the datum and the age of a void fix: those of the daemon that sends its messages, else
/// those of the configuration.
void set_facts(const std::optional<DaemonFacts>& facts, const DaemonFacts& configured, SensorStory& story);

}  // namespace slamsensor::tools
