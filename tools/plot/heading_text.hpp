#pragma once

#include "tools/plot/svg_writer.hpp"

#include <string>
#include <vector>

namespace slamsensor::tools {

/// Writes a title and summary lines (either may be empty) with their upper left corner at `corner_px`,
/// wrapped to `width_px`. Returns the y of the lower end, px.
double draw_heading(SvgWriter& svg, const std::string& title, const std::vector<std::string>& summary,
                    const core::Point2& corner_px, double width_px);

}  // namespace slamsensor::tools
