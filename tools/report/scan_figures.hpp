#pragma once

#include "core/config.hpp"
#include "core/reading.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

using Scanlines = std::vector<std::vector<core::Reading>>;

/// The spiderweb grid of a scan from above (the paper's Fig. 3), as SVG: each occupied cell coloured by how
/// many scanlines saw something unobstructed in it, and the landmarks that the detector makes of them.
[[nodiscard]] std::string draw_spiderweb(const Scanlines& scanlines, const core::DetectionConfig& config,
                                         const std::string& title);

/// The scanline that shows the most unobstructed cells; none when no scanline is looked at.
[[nodiscard]] std::optional<std::size_t> richest_scanline(const Scanlines& scanlines,
                                                          const core::DetectionConfig& config);

/// The one-row grid of a scanline (the paper's Fig. 4), as SVG: distance over bearing, with the columns of
/// unobstructed clusters, those of others, and those without a return.
[[nodiscard]] std::string draw_scanline(const std::vector<core::Reading>& scanline,
                                        const core::DetectionConfig& config, const std::string& title);

}  // namespace slamsensor::tools
