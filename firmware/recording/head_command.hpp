#pragma once

#include "firmware/recording/tape_format.hpp"
#include "firmware/scan/sensor_head.hpp"

namespace slamsensor::firmware {

/// Tells `head` what `what` stands for. A command that is recorded is given through this and no other way, so
/// that it is the same when it is played. An argument that stands for nothing is passed over.
void command(SensorHead& head, TapeCommand what, std::uint64_t argument) noexcept;

}  // namespace slamsensor::firmware
