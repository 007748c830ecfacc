#include "tools/emulator/ptu/ptu_unit.hpp"

namespace slamsensor::tools {

void PtuUnit::save() {
  saved = head.config;
  ++eeprom_writes;
}

}  // namespace slamsensor::tools
