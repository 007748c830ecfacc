#pragma once

#include "tools/emulator/ptu/ptu_unit.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace slamsensor::tools {

/// What the query `opcode` of the binary interface is answered; nothing when it is no query of this unit.
[[nodiscard]] std::optional<std::string> query_cpi(const PtuUnit& unit, std::uint8_t opcode, Stamp now);

}  // namespace slamsensor::tools
