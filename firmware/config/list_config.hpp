#pragma once

#include "firmware/config/load_config.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// One aligned line per key: "detection.range_max_m = 300.0 m   default", or "... f.toml:12"; "none" for the
/// keys of an absent section.
[[nodiscard]] std::string list_config(const LoadedConfig& loaded);

/// The commented default file: every section, key, unit, allowed range and default. Loading it gives
/// Config{}. The sections that are absent by default stand in it as comments.
[[nodiscard]] std::string default_config_text();

/// Every key of `config` that has a value, a line each ("detection.range_max_m = 300.0"): a TOML document
/// that the sensor loads. A number of which no decimal reads back exactly (a built-in default in radians,
/// say) has its bits in a comment of its own.
[[nodiscard]] std::string config_toml(const Config& config);

/// Lays what config_toml wrote over `onto`: the same values, bit for bit. Mistakes as apply_layer reports
/// them; a comment with bits that are not those of the decimal above all but for rounding is passed over.
[[nodiscard]] std::vector<ConfigError> apply_config_toml(LoadedConfig& onto, std::string_view toml,
                                                         std::string_view name);

}  // namespace slamsensor::firmware
