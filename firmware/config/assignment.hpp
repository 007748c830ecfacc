#pragma once

#include "firmware/config/load_config.hpp"

#include <tl/expected.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// One key with its value, as a person wrote it: TOML, but a text needs no quotes and a list no brackets.
struct Assignment {
  std::string key;
  std::string value;

  friend bool operator==(const Assignment&, const Assignment&) = default;
};

/// "a.b=c" as an assignment; what is wrong with it when there is no equals sign or no key.
[[nodiscard]] tl::expected<Assignment, std::string> parse_assignment(std::string_view text);

/// Lays the assignments over `onto` as one layer called `name`, which has no lines; of two with the same key
/// the later one counts. Returns every mistake, as apply_layer does.
[[nodiscard]] std::vector<ConfigError> apply_assignments(LoadedConfig& onto,
                                                         const std::vector<Assignment>& assignments,
                                                         std::string_view name);

}  // namespace slamsensor::firmware
