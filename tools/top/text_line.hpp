#pragma once

#include "hal/stamp.hpp"
#include "tools/top/canvas.hpp"

#include <string>
#include <vector>

namespace slamsensor::tools {

/// A line of a page.
struct TextLine {
  std::string text;
  CellStyle style = CellStyle::Plain;
};
using TextLines = std::vector<TextLine>;

/// A rectangle of cells.
struct CanvasBox {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Puts `lines` one below the other into `box`, what does not fit left out; returns the row below the last.
int put_lines(Canvas& canvas, const CanvasBox& box, const TextLines& lines);

/// A length of time for a person: "850 us", "7.2 ms", "12.4 s", "3:05 min", "27:14 h", "9 d 3 h".
[[nodiscard]] std::string duration_text(hal::Stamp time);

/// A number with its unit multiple: "999", "1.2 k", "34.0 M".
[[nodiscard]] std::string amount_text(double value);

}  // namespace slamsensor::tools
