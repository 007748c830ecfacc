#pragma once

#include "core/sweep/scan_assembler.hpp"
#include "firmware/scan/scan_scheduler.hpp"
#include "hal/fixed_text.hpp"
#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"
#include "hal/transport/reopen.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {

/// What is known of a pass that was given up.
struct AbortedPass {
  ScanAbort reason = ScanAbort::PanTiltLost;
  AxisMove pan;
  AxisMove tilt;
  std::uint32_t lines_rejected = 0;
  std::uint32_t lines = 0;             ///< that the pass was to have
  std::string_view line_trouble = {};  ///< hal::PanTilt::line_trouble() at its end
};

/// What the readings of a moving axis are like as a whole.
enum class ReadingsFinding : std::uint8_t {
  Varied,     ///< as in any place
  Stuck,      ///< all the same distance and strength
  Zero,       ///< all distance 0 and strength 0, of a device that tells strengths
  Saturated,  ///< an echo too bright to be measured, in every direction
  OverRange,  ///< nothing within range in any direction: an empty place, or a covered lens
};

/// Whether a rangefinder tells something else when it looks elsewhere. No allocation; one thread.
class ReadingsWatch {
 public:
  /// The axis begins to move.
  void begin_line() noexcept;
  void add(const hal::RangeSample& sample) noexcept;
  /// Of the line so far; Varied when it has few readings.
  [[nodiscard]] ReadingsFinding finding() const noexcept;
  [[nodiscard]] std::uint32_t readings() const noexcept { return readings_; }
  [[nodiscard]] double told_m() const noexcept { return first_.told_m; }

 private:
  hal::RangeSample first_;
  std::uint32_t readings_ = 0;
  bool is_same_ = true;
  bool is_none_ = true;       // no echo in any reading
  bool is_saturated_ = true;  // too bright an echo in each
  bool tells_strength_ = false;
};

/// Remembers why a head whose devices answer makes no scans, until it makes one: passes that were given up in
/// a row and lines that could not be used. Says so in words with the device, what was asked of it, what was
/// seen, and what to do. No allocation, no clock; one thread.
class ScanFailure {
 public:
  /// A pass was given up. What the user or the carrier did is no failure of the head, and changes nothing.
  void on_abort(const AbortedPass& pass) noexcept;
  void on_line_rejected(core::LineRejection why) noexcept;
  void on_line() noexcept;
  /// A line was swept whose readings are like this.
  void on_readings(const ReadingsWatch& watch) noexcept;
  /// A pass was made to its end.
  void on_pass() noexcept;
  /// All readings of the last line are alike: nothing can be made of the scan.
  [[nodiscard]] bool is_stuck() const noexcept {
    return finding_ == ReadingsFinding::Stuck || finding_ == ReadingsFinding::Zero ||
           finding_ == ReadingsFinding::Saturated;
  }

  /// The head does not work, although its devices answer: from the first pass on that a blocked or refused
  /// move or its lines ended, from the second in a row on that anything else ended, and from the third
  /// unusable line in a row on; and from the first line on whose
  /// readings are all alike.
  [[nodiscard]] bool is_failing() const noexcept;
  /// In words, for a person, what the last pass or line failed at; empty when nothing did since a whole pass.
  [[nodiscard]] std::string_view text() const noexcept {
    return text_.view().empty() || is_stuck() ? readings_text_.view() : text_.view();
  }

 private:
  std::optional<ScanAbort> reason_;
  std::uint32_t aborts_in_row_ = 0;
  std::uint32_t lines_in_row_ = 0;
  std::optional<core::LineRejection> rejection_;  // of the last line
  hal::FixedText<hal::kProblemMax> text_;
  ReadingsFinding finding_ = ReadingsFinding::Varied;  // of the last line
  std::uint32_t alike_ = 0;                            // readings in a row that gave the same finding
  bool is_pass_empty_ = true;                          // so far: OverRange in each line
  hal::FixedText<hal::kProblemMax> readings_text_;
};

}  // namespace slamsensor::firmware
