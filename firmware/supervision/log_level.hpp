#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {

/// How grave a message is.
enum class LogLevel : std::uint8_t { Error, Warning, Notice, Info, Debug };

inline constexpr std::array<std::string_view, 5> kLogLevelNames = {"error", "warning", "notice", "info",
                                                                   "debug"};

[[nodiscard]] constexpr std::string_view to_string(LogLevel level) noexcept {
  return kLogLevelNames[static_cast<std::size_t>(level)];
}

/// The level of that name; none when there is none.
[[nodiscard]] constexpr std::optional<LogLevel> log_level(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kLogLevelNames.size(); ++i) {
    if (kLogLevelNames[i] == name) {
      return static_cast<LogLevel>(i);
    }
  }
  return std::nullopt;
}

}  // namespace slamsensor::firmware
