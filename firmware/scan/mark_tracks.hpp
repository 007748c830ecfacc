#pragma once

#include "firmware/scan/line_marks.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::firmware {

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
  MarkTracks();

  /// Forgets all; a new scan begins.
  void clear() noexcept;
  /// Takes the marks of the next line.
  void add(const LineMarks& line) noexcept;

  /// Of the last line.
  [[nodiscard]] std::span<const MarkShift> shifts() const noexcept { return shifts_; }
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

  std::vector<Track> tracks_;
  std::vector<MarkShift> shifts_;
  std::vector<std::size_t> pairs_;     // the track of each mark of the line that is being added
  std::vector<Nearest> nearest_mark_;  // of each track
  MarkTally tally_;
  NearestRanges nearest_{};          // of the line before
  const LineMarks* line_ = nullptr;  // being added
  std::uint32_t lines_ = 0;          // added; the one being added is the last
  std::uint64_t dropped_ = 0;
};

}  // namespace slamsensor::firmware
