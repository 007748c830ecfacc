#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamsensor::tools {

/// The pan-tilt units that can be emulated.
enum class PanTiltModel : std::uint8_t {
  D46_17_5,  ///< the paper's PTU-46-17.5, on a serial line
  D46_70,
  E46_17_5,
  D300E,
  FastE,    ///< no product: the language of the E-series at 300 deg/s without ramps, 23.14 arc seconds
  CanOpen,  ///< two CiA 402 axes on a CAN bus
};

/// The rangefinders that can be emulated.
enum class RangefinderModel : std::uint8_t {
  Lw20,
  Sf30d,
  Sf45,
  Grf500,
  Tf03,
  Tf03Can,
  Lds70a,
  LaserAceIm,  ///< the paper's; its protocol is not public, so this one is a guess
};

/// How a unit is called: `word` in scenario files, `title` to a person.
struct UnitText {
  std::string_view word;
  std::string_view title;
};

/// In the order of the enumerators.
inline constexpr std::array<UnitText, 6> kPtuUnits = {{{"d46-17.5", "PTU-46-17.5"},
                                                       {"d46-70", "PTU-46-70"},
                                                       {"e46-17.5", "PTU-E46-17.5"},
                                                       {"d300e", "PTU-D300E"},
                                                       {"fast-e", "a fast unit that speaks as the E-series"},
                                                       {"canopen", "two CiA 402 axes"}}};
inline constexpr std::array<UnitText, 8> kRangefinderUnits = {
    {{"lw20", "LightWare LW20"},
     {"sf30d", "LightWare SF30/D"},
     {"sf45", "LightWare SF45/B"},
     {"grf500", "LightWare GRF-500"},
     {"tf03", "Benewake TF03"},
     {"tf03-can", "Benewake TF03 (CAN)"},
     {"lds70a", "ASTECH LDS70A"},
     {"laserace-im", "MDL LaserAce IM HR (a guess)"}}};

[[nodiscard]] constexpr const UnitText& text_of(PanTiltModel unit) noexcept {
  return kPtuUnits[static_cast<std::size_t>(unit)];
}
[[nodiscard]] constexpr const UnitText& text_of(RangefinderModel unit) noexcept {
  return kRangefinderUnits[static_cast<std::size_t>(unit)];
}

/// Whether a device has just got its power or has long been running when the scenario starts.
enum class DeviceBegin : std::uint8_t { PowerUp, Ready };

/// What a drive knows of its place when it gets power.
enum class DriveMemory : std::uint8_t {
  Absolute,     ///< counts as before
  Incremental,  ///< counts from 0 where it stands, until it is homed
};

struct PtuProfile {
  PanTiltModel unit = PanTiltModel::D46_17_5;
  DeviceBegin begin = DeviceBegin::PowerUp;
  DriveMemory encoder = DriveMemory::Absolute;  ///< of a CanOpen unit
  std::uint32_t baud = 9600;
  double reply_latency_s = 0.003;  ///< from the end of a command to its answer
  double reply_jitter_s = 0.001;   ///< standard deviation of it
  double position_age_s = 0.0;     ///< of a position when its query is answered
  double boot_s = 0.5;             ///< from power to banner
  double reset_s = 10.0;           ///< of both axes
  double usb_s = 0.0;              ///< the host gets arrivals at its multiples, as from a USB adapter
};

struct RangefinderProfile {
  RangefinderModel unit = RangefinderModel::LaserAceIm;
  DeviceBegin begin = DeviceBegin::PowerUp;
  std::uint32_t baud = 115200;
  double rate_hz = 1000.0;   ///< readings per second until the host asks for another rate
  double latency_s = 0.0;    ///< from a shot to the first bit of its reading
  double jitter_s = 0.0;     ///< standard deviation of it
  double crystal_ppm = 0.0;  ///< how much faster than it should the device's clock runs
  double usb_s = 0.0;        ///< as above
};

/// The inclinometers that can be emulated.
enum class InclinometerModel : std::uint8_t { None, Cia410 };

/// An inclinometer on the carrier, on a CAN bus: it reports how the mount truly leans.
struct InclinometerProfile {
  InclinometerModel unit = InclinometerModel::None;
  std::uint32_t node = 10;
  std::uint32_t resolution = 10;  ///< 1, 10, 100 or 1000 thousandths of a degree
};

/// The devices of a sensor head.
struct HeadProfile {
  PtuProfile ptu{};
  RangefinderProfile rangefinder{};
  InclinometerProfile inclinometer{};
};

enum class HeadKind : std::uint8_t {
  Paper,  ///< PTU-46-17.5 at 9600 baud (1000 positions/s at base speed) and a laser of 1000 readings/s
  Fast,  ///< FastE at 115200 baud and an LW20 of 20,000 readings/s at 921600 baud: a scan of 17 lines in 15 s
};

[[nodiscard]] inline HeadProfile head_profile(HeadKind kind) noexcept {
  HeadProfile profile;
  if (kind == HeadKind::Fast) {
    profile.ptu.unit = PanTiltModel::FastE;
    profile.ptu.baud = 115'200;
    profile.ptu.reset_s = 2.0;
    profile.rangefinder.unit = RangefinderModel::Lw20;
    profile.rangefinder.baud = 921'600;
    profile.rangefinder.rate_hz = 20'000.0;
  }
  return profile;
}

[[nodiscard]] constexpr bool is_on_bus(PanTiltModel unit) noexcept {
  return unit == PanTiltModel::CanOpen;
}
[[nodiscard]] constexpr bool is_on_bus(RangefinderModel unit) noexcept {
  return unit == RangefinderModel::Tf03Can;
}

}  // namespace slamsensor::tools
