#pragma once

#include <string>

namespace slamsensor::hal {

/// Why a transport or driver could not be made: device, value seen, what is allowed and what to do, in one
/// line.
struct InitError {
  std::string message;
};

}  // namespace slamsensor::hal
