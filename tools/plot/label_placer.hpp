#pragma once

#include "core/geometry/pose2.hpp"
#include "tools/plot/svg_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace slamsensor::tools {

/// What a label may stand on, from the worst to the least evil.
enum class Obstacle : std::uint8_t { Label, Marker, Line, Cross };

/// A label to place.
struct LabelRequest {
  core::Point2 anchor_px = core::Point2::Zero();  ///< what it names
  double width_px = 0.0;
  double height_px = 0.0;
  double gap_px = 0.0;  ///< between the anchor and the nearest side of the label
  Obstacle tolerated_from =
      Obstacle::Cross;  ///< it may stand on these and lesser evils, when there is no better place
  int rings = 1;        ///< how many distances are tried, from `gap_px` outwards
};

/// Finds free places for labels in a picture. No two labels it places overlap, and all are inside the frame.
class LabelPlacer {
 public:
  explicit LabelPlacer(const Box& frame);

  /// Later labels keep off `box` as far as their request says.
  void block(const Box& box, Obstacle kind);
  /// The same for the line from `a` to `b`.
  void block_line(const core::Point2& a, const core::Point2& b);

  /// A place for the label beside its anchor, which is then taken, or none. Of several, one on fewer kinds of
  /// obstacle, then one nearer, then one further right and up.
  [[nodiscard]] std::optional<Box> place(const LabelRequest& request);

 private:
  struct Blocked {
    Box box;
    Obstacle kind;
  };

  [[nodiscard]] bool is_free(const Box& box, Obstacle worst_tolerated) const;
  [[nodiscard]] std::optional<Box> find(const LabelRequest& request, int rings,
                                        Obstacle worst_tolerated) const;
  [[nodiscard]] std::optional<Box> find(const LabelRequest& request, int rings) const;
  template <typename Visit>
  void for_cells(const Box& box, Visit visit) const;

  Box frame_;
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
  std::vector<std::vector<Blocked>> cells_;
};

}  // namespace slamsensor::tools
