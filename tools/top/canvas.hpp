#pragma once

#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

struct screen;  // of curses

namespace slamsensor::tools {

/// How a cell of a text screen looks.
enum class CellStyle : std::uint8_t { Plain, Bold, Dim, Good, Warning, Bad, Inverse };

/// A text screen in memory, `width` by `height` cells of printable ASCII, blank at first. What is drawn
/// outside of it is left out.
class Canvas {
 public:
  struct Cell {
    char c = ' ';
    CellStyle style = CellStyle::Plain;
  };

  /// Negative sizes are taken as 0, sizes above kSizeMax as that.
  Canvas(int width, int height);
  static constexpr int kSizeMax = 1000;

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] const Cell& at(int x, int y) const { return cells_.at(index(x, y)); }

  /// `text` from column `x` of row `y` on; anything but printable ASCII becomes '?'.
  void put(int x, int y, std::string_view text, CellStyle style = CellStyle::Plain);

  /// The rows as lines without blanks at their ends.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_;
  int height_;
  std::vector<Cell> cells_;
};

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

/// What a person pressed.
enum class TopKey : std::uint8_t { None, Quit, Sensor, Counters, Channels, NextPage, Up, Down, Redraw };

/// The terminal as a screen: taken over at creation, as it was before at the end. At most one at a time.
class Terminal {
 public:
  /// Colours are used unless NO_COLOR is set to something or the terminal has none. The error says what
  /// terminal it cannot use.
  [[nodiscard]] static tl::expected<std::unique_ptr<Terminal>, std::string> open();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal();

  /// Size in cells, as it is now.
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;

  void show(const Canvas& canvas);

  /// The next key that was pressed; None when there is none. Never waits.
  [[nodiscard]] TopKey next_key();

 private:
  explicit Terminal(::screen* handle);

  ::screen* handle_;
  bool has_colours_ = false;
};

}  // namespace slamsensor::tools
