#pragma once

#include "core/sweep/scan_assembler.hpp"
#include "firmware/scan/scan_scheduler.hpp"
#include "hal/fixed_text.hpp"
#include "hal/pantilt/pan_tilt.hpp"
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
  std::uint32_t lines = 0;  ///< that the pass was to have
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
  /// A pass was made to its end.
  void on_pass() noexcept;

  /// The head does not work, although its devices answer: from the first pass on that a blocked or refused
  /// move or its lines ended, from the second in a row on that anything else ended, and from the third
  /// unusable line in a row on.
  [[nodiscard]] bool is_failing() const noexcept;
  /// In words, for a person, what the last pass or line failed at; empty when nothing did since a whole pass.
  [[nodiscard]] std::string_view text() const noexcept { return text_.view(); }

 private:
  std::optional<ScanAbort> reason_;
  std::uint32_t aborts_in_row_ = 0;
  std::uint32_t lines_in_row_ = 0;
  std::optional<core::LineRejection> rejection_;  // of the last line
  hal::FixedText<hal::kProblemMax> text_;
};

}  // namespace slamsensor::firmware
