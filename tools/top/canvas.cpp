#include "tools/top/canvas.hpp"

#include <algorithm>

namespace slamsensor::tools {

Canvas::Canvas(int width, int height)
    : width_(std::clamp(width, 0, kSizeMax)),
      height_(std::clamp(height, 0, kSizeMax)),
      cells_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
}

void Canvas::put(int x, int y, std::string_view text, CellStyle style) {
  if (y < 0 || y >= height_) {
    return;
  }
  for (const char c : text) {
    if (x >= width_) {
      return;
    }
    if (x >= 0) {
      cells_[index(x, y)] = {c >= ' ' && c <= '~' ? c : '?', style};
    }
    ++x;
  }
}

std::string Canvas::text() const {
  std::string out;
  for (int y = 0; y < height_; ++y) {
    std::string line;
    for (int x = 0; x < width_; ++x) {
      line += at(x, y).c;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  }
  return out;
}

}  // namespace slamsensor::tools
