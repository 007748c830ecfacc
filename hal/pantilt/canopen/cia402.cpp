#include "hal/pantilt/canopen/cia402.hpp"

#include <array>

namespace slamsensor::hal {
namespace {

struct Pattern {
  std::uint32_t mask;
  std::uint32_t value;
  DriveState state;
};

constexpr std::array kPatterns{
    Pattern{0x004F, 0x0000, DriveState::NotReady},
    Pattern{0x004F, 0x0040, DriveState::SwitchOnDisabled},
    Pattern{0x006F, 0x0021, DriveState::ReadyToSwitchOn},
    Pattern{0x006F, 0x0023, DriveState::SwitchedOn},
    Pattern{0x006F, 0x0027, DriveState::OperationEnabled},
    Pattern{0x006F, 0x0007, DriveState::QuickStop},
    Pattern{0x004F, 0x000F, DriveState::FaultReaction},
    Pattern{0x004F, 0x0008, DriveState::Fault},
};

}  // namespace

DriveState drive_state(std::uint32_t statusword) noexcept {
  for (const Pattern& pattern : kPatterns) {
    if ((statusword & pattern.mask) == pattern.value) {
      return pattern.state;
    }
  }
  return DriveState::Unknown;
}

std::uint16_t towards_enabled(DriveState state) noexcept {
  switch (state) {
    case DriveState::SwitchOnDisabled:
      return control::kShutdown;
    case DriveState::ReadyToSwitchOn:
      return control::kSwitchOn;
    case DriveState::SwitchedOn:
    case DriveState::OperationEnabled:
      return control::kEnable;
    case DriveState::Fault:
      return control::kFaultReset;
    case DriveState::NotReady:
    case DriveState::QuickStop:
    case DriveState::FaultReaction:
    case DriveState::Unknown:
      break;
  }
  return control::kDisableVoltage;
}

}  // namespace slamsensor::hal
