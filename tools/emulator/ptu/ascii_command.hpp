#pragma once

#include "tools/emulator/ptu/ptu_head.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// What a command makes the unit do and say.
struct AsciiAnswer {
  enum class Wait : std::uint8_t {
    None,    ///< answers after the reply latency
    Motion,  ///< when both axes are still
    Reset,   ///< when the reset has ended
    Time,    ///< after `time`
  };

  std::string bytes;  ///< all of them, with mark and line end; empty for none
  Wait wait = Wait::None;
  PtuAxes reset{};                      ///< of Wait::Reset
  Stamp time{};                         ///< of Wait::Time
  std::optional<std::uint32_t> baud{};  ///< the line rate from now on
};

/// The controller behind the command interpreter: the head, what it remembers without power, and how it is
/// spoken to.
struct PtuUnit {
  PtuUnit(const PtuSettings& all, std::uint64_t seed)
      : settings(all), head(all, seed), saved(factory_config(all)) {}

  const PtuSettings& settings;
  PtuHead head;
  PtuMemory saved;  ///< in the EEPROM
  std::uint32_t eeprom_writes = 0;
  int selected_unit = 0;  ///< last unit the host has selected; 0: all

  [[nodiscard]] bool is_networked() const noexcept { return head.config.unit_id != 0; }

  /// Whether commands are for this unit, and whether it may answer them.
  [[nodiscard]] bool is_addressed() const noexcept {
    return !is_networked() || selected_unit == 0 || selected_unit == head.config.unit_id;
  }
  [[nodiscard]] bool may_speak() const noexcept {
    return !is_networked() || selected_unit == head.config.unit_id;
  }

  void save() {
    saved = head.config;
    ++eeprom_writes;
  }

  /// Settings back as saved, or as they left the factory.
  void restore() { head.config = saved; }
  void restore_factory() { head.config = factory_config(settings); }
};

/// Obeys `text`, which has no delimiter in it and is not empty, and says what to answer (PTU-D46 User's
/// Manual 2.14, "Command reference"). It knows the commands by which a driver sets up, moves, reads and
/// resets a unit; to all others it answers as to an illegal command.
[[nodiscard]] AsciiAnswer obey_ascii(PtuUnit& unit, std::string_view text, Stamp now);

}  // namespace slamsensor::tools
