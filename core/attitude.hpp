#pragma once

namespace slamsensor::core {

/// How the sensor leans (the paper's section II-A: it stands upright, or its roll and pitch are known).
///
/// Axes of L: x' forward, y' left, z' up (ISO 8855, REP 103); both angles are right-handed. Roll turns about
/// x': positive lifts the left side. Pitch turns about y': positive lowers the front. The level frame V has
/// its z axis along the vertical and its x axis below or above x': R_V_L = R_y(pitch) R_x(roll). No heading
/// is in it, so that the heading of a levelled scan is that of x' seen from above.
struct Attitude {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
};

}  // namespace slamsensor::core
