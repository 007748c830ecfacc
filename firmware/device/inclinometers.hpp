#pragma once

#include "firmware/device/head_config.hpp"
#include "firmware/scan/scan_config.hpp"
#include "hal/inclination/inclinometer.hpp"
#include "hal/init_error.hpp"
#include "hal/transport/can_link.hpp"

#include <tl/expected.hpp>

#include <memory>

namespace slamsensor::firmware {

/// An inclinometer with the link that it is on.
struct OwnedInclinometer {
  std::unique_ptr<hal::CanLink> can;  ///< null for one that is on no bus
  std::unique_ptr<hal::Inclinometer> device;
};

/// The inclinometer that `source` asks for, with no device in it for None and Fixed. A device that is not
/// there is no error. The error tells what is wrong with the section [inclination].
[[nodiscard]] tl::expected<OwnedInclinometer, hal::InitError> open_inclinometer(const HeadConfig& config,
                                                                                InclinationSource source);

}  // namespace slamsensor::firmware
