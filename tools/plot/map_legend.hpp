#pragma once

#include "tools/plot/map_frame.hpp"
#include "tools/plot/map_plot.hpp"
#include "tools/plot/svg_writer.hpp"

namespace slamsensor::tools {

/// Width of the strip that the legend needs, px.
inline constexpr double kLegendWidth_px = 164.0;

/// Draws the key of the marks that `plot` has, the colour bar of xi and the scale bar, with the upper left
/// corner at `corner_px`. Returns the y of its lower end, px.
double draw_map_legend(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame,
                       const core::Point2& corner_px);

}  // namespace slamsensor::tools
