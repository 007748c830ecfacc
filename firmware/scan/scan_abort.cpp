#include "firmware/scan/scan_abort.hpp"

namespace slamsensor::firmware {
namespace {

// In the order of HoldReason.
constexpr std::array<std::string_view, kHoldReasons> kHolds = {
    "the laser interlock is open or cannot be read; close it to scan",
    "paused on command; resume to scan",
    "the inclinometer does not tell how the sensor leans; check it, or set inclination.source",
    "the sensor leans by more than inclination.max_lean_deg; set it upright",
};

// In the order of ScanDoubt; an LCM status has room for 191 characters.
constexpr std::array<std::string_view, kScanDoubts> kDoubts = {
    "the timing of a device was in doubt during the scan",
    "the pan-tilt unit's positions are timed too loosely; check its line, or scan more slowly",
    "pan-tilt unit and rangefinder are not timed yet: too little is seen; or set latency.initial_s",
    "pan-tilt unit and rangefinder are apart in time by more than before; being measured anew",
};

}  // namespace

std::string_view describe(ScanDoubt doubt) noexcept {
  return kDoubts[static_cast<std::size_t>(doubt)];
}

std::string_view describe(HoldReason reason) noexcept {
  return kHolds[static_cast<std::size_t>(reason)];
}

}  // namespace slamsensor::firmware
