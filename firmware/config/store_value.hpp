#pragma once

#include "firmware/config/setting.hpp"

#include <tl/expected.hpp>
#include <toml++/toml.h>

#include <optional>
#include <string>

namespace slamsensor::firmware {

/// Stores what stands in the file as the value of `setting`; or returns what is wrong with it ("is out of
/// range"), and `config` is as before.
[[nodiscard]] std::optional<std::string> store_value(const Setting& setting, const toml::node& node,
                                                     Config& config);

/// What was written, for a message of one line.
[[nodiscard]] std::string written_text(const toml::node& node);

}  // namespace slamsensor::firmware
