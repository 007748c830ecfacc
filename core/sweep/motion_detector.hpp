#pragma once

#include "core/memory/fixed_vector.hpp"
#include "core/sweep/marks.hpp"
#include "core/sweep/sweep_config.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// How the sensor would have moved.
enum class MotionKind : std::uint8_t {
  Jump,   ///< once: all that was seen before is displaced by the same
  Creep,  ///< steadily: what was first seen longer ago is displaced by more
};

/// How the sensor moved in its own plane between two lines, by what they saw: x' forward, y' left, turned
/// counter-clockwise. Of a creep: over the longest time between two sights of a mark.
struct MotionEstimate {
  double x_m = 0.0;
  double y_m = 0.0;
  double turn_rad = 0.0;
  double distance_m = 0.0;        ///< of x_m, y_m
  double distance_sigma_m = 0.0;  ///< 1 sigma along x_m, y_m
  double turn_sigma_rad = 0.0;
  double agreeing = 0.0;  ///< [0, 1] share of what the marks say that bears it out
};

/// Fits MotionEstimate to the shifts of marks, robustly (Huber, then Tukey). What is
/// seen at different heights is displaced also without motion: by a mount that leans, all along one line, and
/// by shapes that recede with height; both are fitted beside it. Its sigmas are the greater of those by
/// scatter and of those by leaving out one sector of bearings after the other (jackknife), so that what moves
/// by itself in one direction moves nothing. No allocation after construction; one thread.
class MotionFitter {
 public:
  /// Nothing when the shifts are fewer than `things_min`, or all in one direction.
  [[nodiscard]] std::optional<MotionEstimate> fit(std::span<const MarkShift> shifts, MotionKind kind,
                                                  std::uint32_t things_min) noexcept;

 private:
  static constexpr std::size_t kUnknowns = 6;  // x, y, turn, recession, lean along x and y
  static constexpr std::size_t kSectors = 12;

  /// One equation: coefficients * unknowns = value, in sigmas.
  struct Row {
    std::array<double, kUnknowns> coefficients{};
    double value = 0.0;
    double residual = 0.0;
    double weight = 1.0;
    std::size_t sector = 0;
  };
  using Solution = std::array<double, kUnknowns>;
  struct Normal;  // equations

  void collect(std::span<const MarkShift> shifts, MotionKind kind) noexcept;
  void add_row(const std::array<double, 3>& motion, double recession, double value, double sigma) noexcept;
  void update_residuals(const Solution& solution) noexcept;
  [[nodiscard]] double scale() noexcept;
  void weigh_huber() noexcept;
  void weigh_tukey() noexcept;
  [[nodiscard]] MotionEstimate judge() noexcept;

  FixedVector<Row, 2 * kMarksMax> rows_;
  std::array<double, 2 * kMarksMax> sorted_{};
  double scale_ = 1.0;
  double age_share_ = 1.0;  // of the shift that is being collected
  double rise_m_ = 0.0;
  std::size_t sector_ = 0;
};

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
/// a tree top that is over displace nothing else. In a scan of few lines nothing stands for long: there a
/// line that knows hardly anything of what the others know of each other tells of a move, which has to be as
/// far as marks are told apart by, half a metre or a few degrees. No allocation after construction; work in
/// proportion to the readings; one thread.
class MotionDetector {
 public:
  explicit MotionDetector(const MotionConfig& config) noexcept : config_(config) {}

  /// A new scan.
  void begin_scan() noexcept;
  /// The next line of the scan; nothing of it is kept.
  void add(const Scanline& line) noexcept;
  /// The scan had no more lines.
  void end_scan() noexcept;

  /// Whether the carrier has moved since begin_scan(). Stays true until the next one.
  [[nodiscard]] bool has_moved() const noexcept { return has_moved_; }
  [[nodiscard]] const MotionReport& last_line() const noexcept { return report_; }
  [[nodiscard]] std::uint64_t count(MotionEvent event) const noexcept { return counters_[event]; }

 private:
  static constexpr std::size_t kFewLines = 8;  // of a scan in which nothing stands long enough

  [[nodiscard]] bool is_suspect(const std::optional<MotionEstimate>& estimate) const noexcept;
  [[nodiscard]] bool is_displaced() noexcept;
  [[nodiscard]] bool is_changed() noexcept;
  [[nodiscard]] bool breaks_off() noexcept;
  [[nodiscard]] bool is_incoherent() noexcept;
  /// What a line saw of what the lines before had seen.
  struct KnownShare {
    double known = 0.0;
    double sigma = 0.0;
    bool has_risen = false;
  };
  [[nodiscard]] static KnownShare known_share(const MarkTally& tally) noexcept;
  [[nodiscard]] bool breaks_off_from(const KnownShare& other, const KnownShare& line) const noexcept;
  void give_up(MotionEvent why) noexcept;

  MotionConfig config_;
  LineMarks marks_;
  MarkTracks tracks_;
  MotionFitter fitter_;
  MotionReport report_;
  std::array<std::optional<MotionEstimate>, 2> suspects_;  // of the last line, by MotionKind
  std::uint32_t suspect_ = 0;                              // lines in a row
  std::uint32_t incoherent_ = 0;                           // likewise
  FixedVector<KnownShare, kFewLines> known_shares_;        // of the first lines but the very first
  KnownShare last_known_;
  bool is_broken_ = false;  // the last line: see breaks_off()
  bool has_moved_ = false;
  EventCounts<MotionEvent, kMotionEvents> counters_;
};

}  // namespace slamsensor::core
