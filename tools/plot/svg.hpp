#pragma once

#include "core/geometry/pose2.hpp"
#include "tools/output/text_output.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// `words` is appended so that it stands between XML tags or quotes as it is: markup is escaped, and every
/// byte that is not part of valid UTF-8 or not allowed in XML 1.0 becomes '?'.
void append_xml_text(std::string& out, std::string_view words);

/// An upper estimate of the width of `words` in the fonts the pictures name, px, for a font of `size_px`.
[[nodiscard]] double text_width_px(std::string_view words, double size_px);

/// `words` cut at spaces into lines that are at most `width_px` wide; a word that is wider stands alone.
/// Never empty.
[[nodiscard]] std::vector<std::string> wrap_text(std::string_view words, double size_px, double width_px);

/// A rectangle of the picture, px, y down.
struct PixelBox {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;

  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
  [[nodiscard]] bool overlaps(const PixelBox& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  [[nodiscard]] bool contains(const PixelBox& other) const {
    return left <= other.left && top <= other.top && right >= other.right && bottom >= other.bottom;
  }
};

/// A square around `centre`, `half` px to each side.
[[nodiscard]] inline PixelBox box_around(const core::Point2& centre, double half) {
  return {centre.x() - half, centre.y() - half, centre.x() + half, centre.y() + half};
}

/// The data of an SVG path, px with two decimals.
class PathData {
 public:
  void move_to(const core::Point2& p);
  void line_to(const core::Point2& p);
  void segment(const core::Point2& a, const core::Point2& b);
  void plus(const core::Point2& centre, double half);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] bool empty() const { return text_.empty(); }

 private:
  std::string text_;
};

/// Writes an SVG picture, element by element; equal calls give equal bytes. `attributes` are written as they
/// are
/// (`stroke="#000"`); texts are escaped, and bytes that are no UTF-8 or no XML become '?'. (Not cairo: it
/// draws words by the fonts of the machine, and a sensor without a screen has none.)
class SvgWriter {
 public:
  void open_group(std::string_view attributes);
  /// As `open_group`, with everything outside `box` cut off; `name` is of this box alone.
  void open_clipped_group(const PixelBox& box, std::string_view name);
  void close_group();
  void line(const core::Point2& a, const core::Point2& b, std::string_view attributes = {});
  void rect(const PixelBox& box, std::string_view attributes = {});
  void circle(const core::Point2& centre, double radius, std::string_view attributes = {});
  /// Nothing is written for an empty path.
  void path(const PathData& data, std::string_view attributes = {});
  void text(const core::Point2& baseline, std::string_view words, std::string_view attributes = {});
  /// As `text`, with `exponent` raised behind `base`.
  void power(const core::Point2& baseline, std::string_view base, std::string_view exponent,
             std::string_view attributes = {});

  /// The whole document, of `width` by `height` px on white, with the elements written so far.
  [[nodiscard]] std::string finish(double width, double height) const;

 private:
  void open(std::string_view element);
  void number(std::string_view name, double value);
  void close(std::string_view attributes);

  std::string body_;
};

/// The attributes of a line.
[[nodiscard]] std::string stroke(std::string_view colour, double width_px);

/// Writes a title and summary lines (either may be empty) with their upper left corner at `corner_px`,
/// wrapped to `width_px`. Returns the y of the lower end, px.
double draw_heading(SvgWriter& svg, const std::string& title, const std::vector<std::string>& summary,
                    const core::Point2& corner_px, double width_px);

/// Draws the SVG file `svg` as the PNG file `png`, twice as large as the SVG says, by rsvg-convert (Debian's
/// librsvg2-bin). The error says what to install when it is not there.
[[nodiscard]] tl::expected<void, OutputError> draw_png(const std::filesystem::path& svg,
                                                       const std::filesystem::path& png);

/// A check of an option that names a picture to be written: what is wrong with its ending, or nothing.
[[nodiscard]] std::string is_picture_name(const std::string& name);

/// The files that write_picture(path, ...) writes.
[[nodiscard]] std::vector<std::filesystem::path> picture_files(const std::filesystem::path& path);

/// `path` holds the picture `svg`. A name that ends in .png gets a PNG, and the SVG stands beside it.
[[nodiscard]] tl::expected<void, OutputError> write_picture(const std::filesystem::path& path,
                                                            std::string_view svg);

inline constexpr double kScaleBarMax_px = 120.0;

/// Draws a bar of a round length (m), at most kScaleBarMax_px long, with the upper left corner at `corner_px`
/// and its length above it. Returns the y of its lower end, px.
double draw_scale_bar(SvgWriter& svg, double px_per_m, const core::Point2& corner_px);

}  // namespace slamsensor::tools
