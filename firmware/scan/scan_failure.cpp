#include "firmware/scan/scan_failure.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

namespace slamsensor::firmware {
namespace {

constexpr std::uint32_t kLinesInRow = 3;      // one or two may be a disturbance of the line
constexpr std::uint32_t kReadingsLeast = 50;  // of a line: fewer may be alike by chance
constexpr double kPlainLimit = 1e6;           // no figure of a head is larger
constexpr double kStayed_rad = 0.0035;        // 0.2 deg: more than a resting axis gives way

/// Text and figures one after the other, cut at the length of a problem.
class Sentence {
 public:
  Sentence& operator<<(std::string_view text) noexcept {
    const std::size_t count = std::min(text.size(), text_.size() - size_);
    std::copy_n(text.begin(), count, text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += count;
    return *this;
  }
  Sentence& operator<<(std::uint32_t number) noexcept {
    std::array<char, 12> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end.ptr - digits.data()));
  }
  /// With one decimal.
  Sentence& operator<<(double number) noexcept {
    const double bounded = std::isfinite(number) ? std::clamp(number, -kPlainLimit, kPlainLimit) : 0.0;
    const auto tenths = static_cast<std::int64_t>(std::llround(std::abs(bounded) * 10.0));
    const auto whole = static_cast<std::uint32_t>(tenths / 10);
    const auto rest = static_cast<std::uint32_t>(tenths % 10);
    return *this << (bounded < 0.0 && tenths != 0 ? "-" : "") << whole << "." << rest;
  }
  [[nodiscard]] hal::FixedText<hal::kProblemMax> text() const noexcept {
    return hal::FixedText<hal::kProblemMax>(std::string_view(text_.data(), size_));
  }

 private:
  std::array<char, hal::kProblemMax> text_{};
  std::size_t size_ = 0;
};

double degrees(double angle_rad) noexcept {
  return angle_rad * 180.0 / std::numbers::pi;
}

std::string_view name_of(const AxisMove& move) noexcept {
  return move.axis() == hal::Axis::Pan ? "pan" : "tilt";
}

/// "pan was sent from -110.0 to 110.0 deg and stands at 12.4 deg after 2.9 s"
void tell_move(Sentence& sentence, const AxisMove& move, std::string_view stands) noexcept {
  sentence << name_of(move) << " was sent from " << degrees(move.start_rad()) << " to "
           << degrees(move.target_rad()) << " deg and ";
  if (std::abs(move.seen_rad() - move.start_rad()) < kStayed_rad) {
    sentence << "has not moved";
  } else {
    sentence << stands << " " << degrees(move.seen_rad()) << " deg";
  }
  sentence << " after " << hal::to_seconds(move.waited()) << " s";
}

void tell_repetition(Sentence& sentence, std::uint32_t aborts_in_row) noexcept {
  if (aborts_in_row > 1) {
    sentence << ", " << aborts_in_row << " times in a row";
  }
}

const AxisMove& under_way(const AbortedPass& pass) noexcept {
  return pass.pan.state() == AxisMoveState::Arrived ? pass.tilt : pass.pan;
}

/// What of it is wrong with the lines of a pass; begins with the device.
std::string_view device_of(core::LineRejection why) noexcept {
  return why == core::LineRejection::LinesNoReadings ? "rangefinder: " : "pan-tilt unit: ";
}

std::string_view seen_in(core::LineRejection why) noexcept {
  switch (why) {
    case core::LineRejection::LinesNoReadings:
      return "no reading that can be used, while the axis moved; check its lens, its supply and where it "
             "looks";
    case core::LineRejection::LinesTooFewPolls:
      return "too few positions of the moving axis: its replies came late or not at all; check its line and "
             "the load of this computer";
    case core::LineRejection::LinesTiltMoved:
      return "a tilt axis that did not rest; check its load, its motor's supply and its brake";
    case core::LineRejection::LinesWrongSpeed:
      return "a pan axis that did not go at the speed that was set; check its load and its motor's supply";
    default:
      return "a pan axis that did not move as commanded; check what it rubs on, its load and its supply";
  }
}

void tell_lines(Sentence& sentence, core::LineRejection why, std::uint32_t rejected,
                std::uint32_t lines) noexcept {
  sentence << device_of(why) << rejected;
  if (lines > 0) {
    sentence << " of " << lines;
  }
  sentence << (lines > 0 ? " scanlines had " : " scanlines in a row had ") << seen_in(why);
}

bool is_of_head(ScanAbort reason) noexcept {
  switch (reason) {
    case ScanAbort::PanTiltLost:
    case ScanAbort::RangefinderLost:
    case ScanAbort::MoveRefused:
    case ScanAbort::PanStalled:
    case ScanAbort::TiltStalled:
    case ScanAbort::LinesRejected:
    case ScanAbort::HeadMoved:
      return true;
    case ScanAbort::CarrierMoved:   // the fix says so
    case ScanAbort::TimingInDoubt:  // so does ScanDoubt
    case ScanAbort::Held:
    case ScanAbort::Cancelled:
      break;
  }
  return false;
}

bool is_of_pan_tilt(ScanAbort reason) noexcept {
  return reason == ScanAbort::PanTiltLost || reason == ScanAbort::PanStalled ||
         reason == ScanAbort::TiltStalled || reason == ScanAbort::HeadMoved;
}

/// What happens once may be an accident: a plug that was touched, a hand on the head.
bool is_accident(ScanAbort reason) noexcept {
  return reason == ScanAbort::PanTiltLost || reason == ScanAbort::RangefinderLost ||
         reason == ScanAbort::HeadMoved;
}

}  // namespace

void ReadingsWatch::begin_line() noexcept {
  readings_ = 0;
  is_same_ = true;
  is_none_ = true;
  is_saturated_ = true;
}

void ReadingsWatch::add(const hal::RangeSample& sample) noexcept {
  if (readings_++ == 0) {
    first_ = sample;
  }
  is_same_ = is_same_ && sample.told_m == first_.told_m && sample.range_m == first_.range_m &&
             sample.strength == first_.strength && sample.echo == first_.echo;
  is_none_ = is_none_ && sample.echo == hal::Echo::None;
  is_saturated_ = is_saturated_ && sample.echo == hal::Echo::Saturated;
  tells_strength_ = tells_strength_ || sample.strength != 0.0;
}

ReadingsFinding ReadingsWatch::finding() const noexcept {
  if (readings_ < kReadingsLeast) {
    return ReadingsFinding::Varied;
  }
  if (is_saturated_) {
    return ReadingsFinding::Saturated;
  }
  if (is_same_ && first_.echo != hal::Echo::None) {
    return ReadingsFinding::Stuck;
  }
  if (is_same_ && first_.told_m == 0.0 && first_.strength == 0.0 && tells_strength_) {
    return ReadingsFinding::Zero;
  }
  return is_none_ ? ReadingsFinding::OverRange : ReadingsFinding::Varied;
}

void ScanFailure::on_abort(const AbortedPass& pass) noexcept {
  if (!is_of_head(pass.reason)) {
    return;
  }
  reason_ = pass.reason;
  ++aborts_in_row_;
  Sentence sentence;
  if (is_of_pan_tilt(pass.reason) && !pass.line_trouble.empty()) {
    text_ =
        hal::FixedText<hal::kProblemMax>(pass.line_trouble);  // what was seen over this line is no evidence
    return;
  }
  switch (pass.reason) {
    case ScanAbort::PanStalled:
    case ScanAbort::TiltStalled: {
      const AxisMove& move = pass.reason == ScanAbort::PanStalled ? pass.pan : pass.tilt;
      sentence << "pan-tilt unit: ";
      tell_move(sentence, move, "stands at");
      tell_repetition(sentence, aborts_in_row_);
      sentence << "; check what blocks it, its motor's supply, its cable";
      break;
    }
    case ScanAbort::MoveRefused: {
      const AxisMove& move = pass.pan.state() == AxisMoveState::Refused ? pass.pan : pass.tilt;
      sentence << "pan-tilt unit: it refused to send " << name_of(move) << " to "
               << degrees(move.target_rad()) << " deg at " << degrees(move.speed_radps()) << " deg/s";
      tell_repetition(sentence, aborts_in_row_);
      sentence << "; check its limits and the settings [scan]";
      break;
    }
    case ScanAbort::PanTiltLost:
      sentence << "pan-tilt unit: it was lost in the scan";
      tell_repetition(sentence, aborts_in_row_);
      sentence << ": ";
      tell_move(sentence, under_way(pass), "was seen last at");
      sentence << "; check its supply and its cable";
      break;
    case ScanAbort::RangefinderLost:
      sentence << "rangefinder: it was lost in the scan";
      tell_repetition(sentence, aborts_in_row_);
      sentence << "; check its supply and its cable, and whether the turning head pulls at it";
      break;
    case ScanAbort::HeadMoved:
      sentence << "pan-tilt unit: an axis that rested was pushed away";
      tell_repetition(sentence, aborts_in_row_);
      sentence << "; check what touches the head, and the supply of its motors";
      break;
    default:
      tell_lines(sentence, rejection_.value_or(core::LineRejection::LinesOffModel), pass.lines_rejected,
                 pass.lines);
      break;
  }
  text_ = sentence.text();
}

void ScanFailure::on_line_rejected(core::LineRejection why) noexcept {
  rejection_ = why;
  if (++lines_in_row_ >= kLinesInRow && !reason_) {
    Sentence sentence;
    tell_lines(sentence, why, lines_in_row_, 0);
    text_ = sentence.text();
  }
}

void ScanFailure::on_readings(const ReadingsWatch& watch) noexcept {
  const ReadingsFinding found = watch.finding();
  const bool was_stuck = is_stuck();
  alike_ = found == finding_ ? alike_ : 0;
  finding_ = found;
  alike_ += watch.readings();
  is_pass_empty_ = is_pass_empty_ && found == ReadingsFinding::OverRange;
  if (found == ReadingsFinding::OverRange) {
    readings_text_ = was_stuck ? hal::FixedText<hal::kProblemMax>() : readings_text_;
    return;  // one line of many may look at the sky: see on_pass()
  }
  Sentence sentence;
  sentence << "rangefinder: all " << alike_ << " readings ";
  switch (found) {
    case ReadingsFinding::Varied:
    case ReadingsFinding::OverRange:
      alike_ = 0;
      readings_text_ = {};
      return;
    case ReadingsFinding::Stuck:
      sentence << "of the scan are identical (" << watch.told_m()
               << " m): lens covered, or the device is stuck; clean it, switch it off and on";
      break;
    case ReadingsFinding::Saturated:
      sentence << "of the scan are saturated, too bright to be measured: look for what shines back right "
                  "before the lens, a window or a cap";
      break;
    case ReadingsFinding::Zero:
      sentence << "of the scan are distance 0 and strength 0: lens covered, or its receiver is dead; clean "
                  "it, switch it off and on";
      break;
  }
  readings_text_ = sentence.text();
}

void ScanFailure::on_line() noexcept {
  lines_in_row_ = 0;
  if (!reason_) {
    text_ = {};
  }
}

void ScanFailure::on_pass() noexcept {
  if (is_pass_empty_ && finding_ == ReadingsFinding::OverRange) {
    Sentence sentence;
    sentence
        << "rangefinder: all " << alike_
        << " readings of the scan are over range or without echo: nothing around, or its lens is covered";
    readings_text_ = sentence.text();
  }
  is_pass_empty_ = true;
  reason_.reset();
  aborts_in_row_ = 0;
  if (lines_in_row_ < kLinesInRow) {
    text_ = {};
  }
}

bool ScanFailure::is_failing() const noexcept {
  return is_stuck() || lines_in_row_ >= kLinesInRow || aborts_in_row_ > 1 ||
         (reason_ && !is_accident(*reason_));
}

}  // namespace slamsensor::firmware
