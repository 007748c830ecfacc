#include "firmware/recording/config_toml.hpp"

#include "firmware/config/setting.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace slamsensor::firmware {
namespace {

constexpr std::string_view kBitsMark = "# bits: ";
constexpr double kRounding = 1e-14;  // some units in the last place

/// Where a real number is stored; null for other settings and absent sections.
const double* real_of(const Setting& setting, const Config& config) {
  const auto* const real = std::get_if<RealSetting>(&setting.kind);
  return real != nullptr ? real->member.read(config) : nullptr;
}

/// "# bits: PATH HEX" for each real number that `toml` does not give again.
std::string bits_of(const Config& config, const std::string& toml) {
  LoadedConfig read;
  static_cast<void>(apply_layer(read, toml, "settings"));
  std::string lines;
  for (const Setting& setting : settings()) {
    const double* const wanted = real_of(setting, config);
    const double* const got = real_of(setting, read.config);
    if (wanted == nullptr || got == nullptr || *wanted == *got) {
      continue;
    }
    char hex[17] = {};
    std::to_chars(hex, hex + 16, std::bit_cast<std::uint64_t>(*wanted), 16);
    lines.append(kBitsMark).append(setting.path).append(" ").append(hex).append("\n");
  }
  return lines;
}

/// Sets the number that a line names, if it is the one that is there but for rounding.
void apply_bits(Config& config, std::string_view line) {
  const std::size_t space = line.find(' ');
  const auto index = find_setting(line.substr(0, space));
  if (space == std::string_view::npos || !index) {
    return;
  }
  const auto* const real = std::get_if<RealSetting>(&settings()[*index].kind);
  const double* const value = real != nullptr ? real->member.read(config) : nullptr;
  std::uint64_t bits = 0;
  const auto [end, error] = std::from_chars(line.data() + space + 1, line.data() + line.size(), bits, 16);
  if (value == nullptr || error != std::errc() || end != line.data() + line.size()) {
    return;
  }
  const auto exact = std::bit_cast<double>(bits);
  if (std::abs(exact - *value) <= kRounding * std::abs(*value)) {
    *real->member.write(config) = exact;
  }
}

}  // namespace

std::string config_toml(const Config& config) {
  std::string toml;
  for (const Setting& setting : settings()) {
    if (const auto value = value_text(setting, config)) {
      toml.append(setting.path).append(" = ").append(*value).append("\n");
    }
  }
  return toml + bits_of(config, toml);
}

std::vector<ConfigError> apply_config_toml(LoadedConfig& onto, std::string_view toml, std::string_view name) {
  std::vector<ConfigError> errors = apply_layer(onto, toml, name);
  while (!toml.empty()) {
    const std::string_view line = toml.substr(0, toml.find('\n'));
    toml.remove_prefix(std::min(line.size() + 1, toml.size()));
    if (line.starts_with(kBitsMark)) {
      apply_bits(onto.config, line.substr(kBitsMark.size()));
    }
  }
  return errors;
}

}  // namespace slamsensor::firmware
