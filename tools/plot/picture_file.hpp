#pragma once

#include "tools/output/text_output.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <string_view>

namespace slamsensor::tools {

/// Draws the SVG file `svg` as the PNG file `png`, twice as large as the SVG says, by rsvg-convert (Debian's
/// librsvg2-bin). The error says what to install when it is not there.
[[nodiscard]] tl::expected<void, OutputError> draw_png(const std::filesystem::path& svg,
                                                       const std::filesystem::path& png);

/// `path` holds the picture `svg`. A name that ends in .png gets a PNG, and the SVG stands beside it.
[[nodiscard]] tl::expected<void, OutputError> write_picture(const std::filesystem::path& path,
                                                            std::string_view svg);

}  // namespace slamsensor::tools
