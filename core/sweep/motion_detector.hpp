#pragma once

#include "core/sweep/marks.hpp"
#include "core/sweep/motion_fit.hpp"
#include "core/sweep/sweep_config.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

enum class MotionEvent : std::uint8_t {
  LinesJudged,      ///< that showed enough to tell how the sensor moved
  LinesNotJudged,   ///< and that did not
  LinesSuspect,     ///< by which it moved; a scan is given up when two agree, or after three in a row
  ScansDisplaced,   ///< given up: what stood is displaced together
  ScansChanged,     ///< given up: what stood is gone and other things are there
  ScansIncoherent,  ///< given up: nothing of a line is seen again in the next ones
  MarksDropped,     ///< no room
};
inline constexpr std::size_t kMotionEvents = 7;

/// What a line said of the carrier's motion.
struct MotionReport {
  std::optional<MotionEstimate> jump;
  std::optional<MotionEstimate> creep;
  MarkTally tally;
};

/// Tells whether the lines of a scan were swept from one place. What stands upright is seen at one bearing
/// and horizontal range in line after line; when all of it is displaced together, or gone and replaced, or
/// nothing is seen twice, then it was the sensor that moved. A bush that rustles, a person who walks by and
/// a tree top that is over displace nothing else. No allocation after construction; work in proportion to
/// the readings; one thread.
class MotionDetector {
 public:
  explicit MotionDetector(const MotionConfig& config) noexcept : config_(config) {}

  /// A new scan.
  void begin_scan() noexcept;
  /// The next line of the scan; nothing of it is kept.
  void add(const Scanline& line) noexcept;

  /// Whether the carrier has moved since begin_scan(). Stays true until the next one.
  [[nodiscard]] bool has_moved() const noexcept { return has_moved_; }
  [[nodiscard]] const MotionReport& last_line() const noexcept { return report_; }
  [[nodiscard]] std::uint64_t count(MotionEvent event) const noexcept { return counters_[event]; }

 private:
  [[nodiscard]] bool is_suspect(const std::optional<MotionEstimate>& estimate) const noexcept;
  [[nodiscard]] bool is_displaced() noexcept;
  [[nodiscard]] bool is_changed() noexcept;
  [[nodiscard]] bool breaks_off() noexcept;
  [[nodiscard]] bool is_incoherent() noexcept;
  void give_up(MotionEvent why) noexcept;

  MotionConfig config_;
  LineMarks marks_;
  MarkTracks tracks_;
  MotionFitter fitter_;
  MotionReport report_;
  std::array<std::optional<MotionEstimate>, 2> suspects_;  // of the last line, by MotionKind
  std::uint32_t suspect_ = 0;                              // lines in a row
  std::uint32_t incoherent_ = 0;                           // likewise
  double known_share_ = 0.0;                               // of what the last line saw
  bool is_broken_ = false;                                 // the last line: see breaks_off()
  bool has_moved_ = false;
  EventCounts<MotionEvent, kMotionEvents> counters_;
};

}  // namespace slamsensor::core
