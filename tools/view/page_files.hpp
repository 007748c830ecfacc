#pragma once

#include <array>
#include <string_view>

namespace slamsensor::tools {

/// A file of the page (tools/view/page), built into the program.
struct PageFile {
  std::string_view path;
  std::string_view type;
  std::string_view content;
};

[[nodiscard]] const std::array<PageFile, 3>& page_files();

}  // namespace slamsensor::tools
