#pragma once

#include "firmware/scan/scanline.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::firmware {

enum class MarkKind : std::uint8_t {
  Post,  ///< a thing of little width before what is farther: a stem, a bush, a person
  Face,  ///< a piece of a surface between two fixed bearings: a wall, the ground
};

/// Something that a scanline saw and that the next line will see at the same place. Ranges are horizontal.
struct Mark {
  MarkKind kind = MarkKind::Post;
  std::uint16_t bin = 0;       ///< of a Face
  double bearing_rad = 0.0;    ///< of its middle
  double range_m = 0.0;        ///< there
  double slope_mprad = 0.0;    ///< of a Face: change of range over bearing
  double bearing_sigma = 0.0;  ///< rad; of a Post
  double range_sigma_m = 0.0;
};

inline constexpr std::size_t kFaceBins = 180;  ///< of 2 deg, from -180 deg on
inline constexpr std::size_t kPostsMax = 240;
inline constexpr std::size_t kMarksMax = kPostsMax + kFaceBins;
inline constexpr std::size_t kNearestBins = 720;  ///< of 0.5 deg, from -180 deg on

/// The nearest return in each bin of bearing, horizontal m; infinite without one.
using NearestRanges = std::array<double, kNearestBins>;

/// The marks of one scanline, found in one pass over its readings. No allocation after construction.
class LineMarks {
 public:
  LineMarks();

  /// Takes `line`; readings beyond `range_max_m` (horizontal) count as no return.
  void build(const Scanline& line, double range_max_m) noexcept;

  [[nodiscard]] std::span<const Mark> marks() const noexcept { return marks_; }
  [[nodiscard]] double tilt_rad() const noexcept { return tilt_rad_; }
  [[nodiscard]] SweepDirection direction() const noexcept { return direction_; }
  [[nodiscard]] std::uint32_t line() const noexcept { return line_; }

  [[nodiscard]] const NearestRanges& nearest() const noexcept { return nearest_; }
  /// The nearest return within about a bin of `bearing_rad`.
  [[nodiscard]] static double nearest_m(const NearestRanges& nearest, double bearing_rad) noexcept;

 private:
  /// Sums over readings that follow a straight line of range over bearing.
  struct Sums {
    double count = 0.0;
    double bearing = 0.0;  // from the first
    double range = 0.0;
    double bearing2 = 0.0;
    double range2 = 0.0;
    double product = 0.0;
    double first_rad = 0.0;
    double last_rad = 0.0;

    void add(double bearing_rad, double range_m) noexcept;
  };
  struct Step {
    double bearing_rad = 0.0;
    double range_m = 0.0;  // infinite without a return
  };

  void take(const Step& step) noexcept;
  void end_run(double next_m) noexcept;
  void end_piece() noexcept;
  void add_post(const Sums& run) noexcept;
  void add_face(const Sums& piece, std::size_t bin) noexcept;

  std::vector<Mark> marks_;
  NearestRanges nearest_{};
  double tilt_rad_ = 0.0;
  SweepDirection direction_ = SweepDirection::Leftwards;
  std::uint32_t line_ = 0;
  double pitch_rad_ = 0.0;  // between readings
  Step before_;             // the reading before
  double before_run_m_ = 0.0;
  Sums run_;
  Sums piece_;  // of the run, within one bin
  std::size_t bin_ = 0;
  std::size_t faces_begin_ = 0;  // of the run under way
  std::size_t posts_ = 0;
};

}  // namespace slamsensor::firmware
