#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamsensor::tools {

/// Axes in the order of all arrays here.
enum class PtuAxisId : std::uint8_t { Pan, Tilt };

inline constexpr std::size_t kPtuAxes = 2;

[[nodiscard]] constexpr std::size_t index_of(PtuAxisId axis) noexcept {
  return static_cast<std::size_t>(axis);
}

enum class PtuKind : std::uint8_t { D46_17_5, D46_70, E46_17_5, D300E };

/// Which command language: the D46 manual's, or the larger one of the E-series Command Reference.
enum class PtuSeries : std::uint8_t { Dp, E };

/// An axis as it leaves the factory. Speeds in positions/s, acceleration in positions/s^2.
struct PtuAxisModel {
  double resolution_arcsec = 0.0;  ///< of one position
  long min_position = 0;           ///< limits as a typical unit finds them at its reset
  long max_position = 0;
  long speed = 0;
  long acceleration = 0;
  long base_speed = 0;
  long lower_speed = 0;
  long upper_speed = 0;
  long upper_speed_max = 0;  ///< what the upper bound can be raised to
};

struct PtuModel {
  std::string_view name;
  PtuSeries series = PtuSeries::Dp;
  PtuAxisModel pan;
  PtuAxisModel tilt;
};

/// The figures of `kind`. Those of the D46-17.5 are from the PTU-D46 User's Manual 2.14; of the others the
/// resolution and the speeds that manuals give, the ranges in degrees from the data sheets.
[[nodiscard]] const PtuModel& ptu_model(PtuKind kind);

}  // namespace slamsensor::tools
