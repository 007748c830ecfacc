#pragma once

#include "firmware/config/load_config.hpp"

#include <string>

namespace slamsensor::firmware {

/// One aligned line per key: "detection.range_max_m = 300.0 m   default", or "... f.toml:12"; "none" for the
/// keys of an absent section.
[[nodiscard]] std::string list_config(const LoadedConfig& loaded);

/// The commented default file: every section, key, unit, allowed range and default. Loading it gives
/// Config{}. The sections that are absent by default stand in it as comments.
[[nodiscard]] std::string default_config_text();

}  // namespace slamsensor::firmware
