#pragma once

#include "tools/plot/map_frame.hpp"
#include "tools/plot/map_layers.hpp"
#include "tools/plot/map_plot.hpp"
#include "tools/plot/svg_writer.hpp"

#include <cstdint>

namespace slamsensor::tools {

/// Which poses are numbered.
enum class Numbers : std::uint8_t { All, Ends };

/// Writes scan numbers beside poses and, where there are few landmarks, xi beside crosses. No two overlap.
/// The numbers of the first and the last pose are always there; of the others, if asked for, the multiples of
/// the smallest round step of which most find a place.
void draw_labels(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes,
                 const std::vector<PoseMark>& poses, Numbers numbers);

}  // namespace slamsensor::tools
