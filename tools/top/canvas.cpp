#include "tools/top/canvas.hpp"

#include "tools/output/number_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

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

namespace {

std::string pair_text(long long first, char separator, long long second, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%lld%c%02lld %s", first, separator, second, unit);
  return text;
}

}  // namespace

int put_lines(Canvas& canvas, const CanvasBox& box, const TextLines& lines) {
  const auto rows = std::min(lines.size(), static_cast<std::size_t>(std::max(0, box.height)));
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string_view text = lines[i].text;
    canvas.put(box.x, box.y + static_cast<int>(i),
               text.substr(0, static_cast<std::size_t>(std::max(0, box.width))), lines[i].style);
  }
  return box.y + static_cast<int>(rows);
}

std::string duration_text(hal::Stamp time) {
  const double seconds = hal::to_seconds(time);
  if (std::abs(seconds) < 0.001) {
    return fixed_text(seconds * 1e6, 0) + " us";
  }
  if (std::abs(seconds) < 1.0) {
    return fixed_text(seconds * 1e3, 1) + " ms";
  }
  if (std::abs(seconds) < 60.0 || seconds < 0.0) {
    return fixed_text(seconds, 1) + " s";
  }
  const auto whole = static_cast<long long>(seconds);
  if (whole < 3600) {
    return pair_text(whole / 60, ':', whole % 60, "min");
  }
  if (whole < 4 * 86'400) {
    return pair_text(whole / 3600, ':', whole / 60 % 60, "h");
  }
  return std::to_string(whole / 86'400) + " d " + std::to_string(whole / 3600 % 24) + " h";
}

std::string amount_text(double value) {
  constexpr std::array<std::string_view, 4> kMultiples = {"", " k", " M", " G"};
  std::size_t multiple = 0;
  while (std::abs(value) >= 999.5 && multiple + 1 < kMultiples.size()) {
    value /= 1000.0;
    ++multiple;
  }
  const bool is_short = multiple == 0 ? value == std::floor(value) : std::abs(value) >= 99.5;
  return fixed_text(value, is_short ? 0 : 1) + std::string(kMultiples[multiple]);
}

}  // namespace slamsensor::tools
