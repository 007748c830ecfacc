#pragma once

#include "tools/top/canvas.hpp"
#include "tools/top/sensor_view.hpp"
#include "tools/top/text_line.hpp"

namespace slamsensor::tools {

/// Draws the map of `view` into `box`, x to the right and y up, as large as it fits with equal axes (a cell
/// is twice as high as wide): '.' landmarks, '+' the path, an arrow '>', '^', '<' or 'v' the last fix by its
/// heading. The last row tells the width in m. Nothing in boxes of fewer than 8 by 4 cells.
void draw_map_sketch(const SensorView& view, const CanvasBox& box, Canvas& canvas);

}  // namespace slamsensor::tools
