#pragma once

#include "firmware/device/head_config.hpp"
#include "firmware/scan/scan_config.hpp"
#include "hal/inclination/inclinometer.hpp"
#include "hal/init_error.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"
#include "hal/transport/byte_link.hpp"
#include "hal/transport/can_link.hpp"

#include <tl/expected.hpp>

#include <memory>

namespace slamsensor::firmware {

/// The links to the devices of a head: of each device either bytes or a CAN bus, the other one null.
struct HeadLinks {
  hal::ByteLink* pan_tilt_bytes = nullptr;
  hal::CanLink* pan_tilt_can = nullptr;
  hal::ByteLink* rangefinder_bytes = nullptr;
  hal::CanLink* rangefinder_can = nullptr;
};

/// Real links, opened by `open_head_links`, or whatever else stands in for them.
struct OwnedHeadLinks {
  std::unique_ptr<hal::ByteLink> pan_tilt_bytes;
  std::unique_ptr<hal::CanLink> pan_tilt_can;
  std::unique_ptr<hal::ByteLink> rangefinder_bytes;
  std::unique_ptr<hal::CanLink> rangefinder_can;

  [[nodiscard]] HeadLinks get() const noexcept {
    return {pan_tilt_bytes.get(), pan_tilt_can.get(), rangefinder_bytes.get(), rangefinder_can.get()};
  }
};

struct HeadDrivers {
  std::unique_ptr<hal::PanTilt> pan_tilt;
  std::unique_ptr<hal::Rangefinder> rangefinder;
};

/// Serial ports and CAN sockets for the devices of `config`, each device with one of its own. A device that
/// is not there is no error: its link is down and comes up by itself. The error names the setting.
[[nodiscard]] tl::expected<OwnedHeadLinks, hal::InitError> open_head_links(const HeadConfig& config);

/// The drivers that `config` asks for on `links`, which outlive them. The error names the setting.
[[nodiscard]] tl::expected<HeadDrivers, hal::InitError> make_head_drivers(const HeadConfig& config,
                                                                          const HeadLinks& links);

/// An inclinometer with the link that it is on.
struct OwnedInclinometer {
  std::unique_ptr<hal::CanLink> can;  ///< null for one that is on no bus
  std::unique_ptr<hal::Inclinometer> device;
};

/// The inclinometer that `source` asks for, with no device in it for None and Fixed. A device that is not
/// there is no error. The error says what is wrong with the section [inclination].
[[nodiscard]] tl::expected<OwnedInclinometer, hal::InitError> open_inclinometer(const HeadConfig& config,
                                                                                InclinationSource source);

}  // namespace slamsensor::firmware
