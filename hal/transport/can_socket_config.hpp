#pragma once

#include "hal/transport/reopen.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace slamsensor::hal {

inline constexpr std::size_t kCanFiltersMax = 16;

/// Passes the data frames of one kind of identifier with (their id & mask) == (id & mask).
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7FF;
  bool extended = false;
};

struct CanConfig {
  std::string interface;  ///< "can0"; up to 15 characters
  std::vector<CanFilter>
      filters;  ///< at most kCanFiltersMax; a frame must pass one of them; none: every frame passes
  ReopenConfig reopen;
};

/// What is wrong with `config`, in words that follow the interface's name; empty when nothing is.
[[nodiscard]] std::string complaint(const CanConfig& config);

}  // namespace slamsensor::hal
