#pragma once

#include "core/memory/fixed_vector.hpp"
#include "core/sweep/swept_line.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::core {

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
inline constexpr std::size_t kTracksMax = 3 * kMarksMax;
inline constexpr std::size_t kNearestBins = 720;  ///< of 0.5 deg, from -180 deg on

/// The nearest return in each bin of bearing, horizontal m; infinite without one.
using NearestRanges = std::array<double, kNearestBins>;

/// The marks of one scanline, found in one pass over its readings. No allocation after construction.
class LineMarks {
 public:
  /// Takes `line`; readings beyond `range_max_m` (horizontal) count as no return.
  void build(const Scanline& line, double range_max_m) noexcept;

  [[nodiscard]] std::span<const Mark> marks() const noexcept { return marks_.span(); }
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

  FixedVector<Mark, kMarksMax> marks_;
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

/// How a mark of this line differs from the first sight of it in a line swept in the same direction, in
/// which it was seen at the same time within the line and with the same latency.
struct MarkShift {
  MarkKind kind = MarkKind::Post;
  double bearing_rad = 0.0;
  double range_m = 0.0;
  double slope_mprad = 0.0;
  double bearing_off_rad = 0.0;  ///< of a Post: this line's less the first's
  double range_off_m = 0.0;
  double bearing_sigma = 0.0;  ///< rad
  double range_sigma_m = 0.0;
  double rise_m = 0.0;  ///< how much higher it was looked at
  double lines = 0.0;   ///< how many lines later
};

/// What became of the marks that were known.
struct MarkTally {
  std::uint32_t seen = 0;       ///< marks of this line that can be told to be old or new
  std::uint32_t known = 0;      ///< of them, seen in one of the lines before
  std::uint32_t standing = 0;   ///< tracks that had stood for some lines, seen in one of the last four
  std::uint32_t lost = 0;       ///< of them, seen neither in the last line nor in this one
  std::uint32_t risen_now = 0;  ///< new in this line, before what was seen until then
  std::uint32_t risen = 0;      ///< new two lines ago, before what was seen until then, and seen ever since
};

/// Follows marks from line to line. No allocation after construction.
class MarkTracks {
 public:
  /// Forgets all; a new scan begins.
  void clear() noexcept;
  /// Takes the marks of the next line.
  void add(const LineMarks& line) noexcept;

  /// Of the last line.
  [[nodiscard]] std::span<const MarkShift> shifts() const noexcept { return shifts_.span(); }
  [[nodiscard]] const MarkTally& tally() const noexcept { return tally_; }
  /// Marks that found no room, since construction.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  struct Track {
    Mark last;
    std::array<Mark, 2> first;  // by direction
    std::array<std::uint32_t, 2> first_line{};
    std::array<double, 2> first_tilt_rad{};
    std::array<bool, 2> has_first{};
    std::uint32_t born = 0;
    std::uint32_t last_line = 0;
    std::uint32_t times = 0;  // seen
    double last_tilt_rad = 0.0;
    bool has_risen = false;  // where it was born, the line before had seen farther
  };

  struct Nearest {
    std::size_t mark = 0;
    double distance = 1.0;
  };
  static constexpr std::size_t kNoTrack = static_cast<std::size_t>(-1);

  void pair_up(std::span<const Mark> marks) noexcept;
  void take(const Mark& mark, std::size_t track) noexcept;
  void meet(Track& track, const Mark& mark) noexcept;
  bool begin(const Mark& mark) noexcept;
  void start(Track& track, const Mark& mark) const noexcept;
  [[nodiscard]] bool stands(const Track& track, const Mark& mark) const noexcept;
  void tell(const Track& track, const Mark& mark) noexcept;
  void count_tracks() noexcept;
  void forget_old() noexcept;

  FixedVector<Track, kTracksMax> tracks_;
  FixedVector<MarkShift, kMarksMax> shifts_;
  std::array<std::size_t, kMarksMax> pairs_{};      // the track of each mark of the line that is being added
  std::array<Nearest, kTracksMax> nearest_mark_{};  // of each track
  MarkTally tally_;
  NearestRanges nearest_{};          // of the line before
  const LineMarks* line_ = nullptr;  // being added
  std::uint32_t lines_ = 0;          // added; the one being added is the last
  std::uint64_t dropped_ = 0;
};

}  // namespace slamsensor::core
