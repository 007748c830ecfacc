#pragma once

#include "firmware/config/load_config.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace slamsensor::firmware {

/// A key that has another value than before.
struct ConfigChange {
  std::size_t index = 0;  ///< in settings()
  std::string before;     ///< as the file writes it; "none" while its section is absent
  std::string after;
  Origin origin;  ///< of the new value

  [[nodiscard]] const Setting& setting() const { return settings()[index]; }
  [[nodiscard]] bool is_live() const { return setting().apply == Apply::Live; }
  /// For the log: "nmea.rate_hz 1.0 -> 5.0 (f.toml:12)", and ": needs a restart" behind it where it does.
  [[nodiscard]] std::string text() const;
};

/// Every key that differs, in the order of settings(). Who set it does not count.
[[nodiscard]] std::vector<ConfigChange> changes(const LoadedConfig& before, const LoadedConfig& after);

/// `running` with those values of `wanted` that can change live, and their origins. Sections that may be
/// absent are so afterwards where they are in `wanted` and live. Rules between keys are not checked.
[[nodiscard]] LoadedConfig with_live_changes(const LoadedConfig& running, const LoadedConfig& wanted);

}  // namespace slamsensor::firmware
