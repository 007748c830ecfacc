#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::hal {

/// What a line from the unit is (PTU-D46 User's Manual, "Command syntax").
enum class PtuLineKind : std::uint8_t {
  Success,   ///< `*` and perhaps a result
  Refusal,   ///< `!` and a message
  Banner,    ///< the unit has just been switched on
  Garbled,   ///< neither
  Overlong,  ///< dropped; no text
};

/// Reports that the unit puts anywhere between other bytes, even inside a reply.
struct PtuMarks {
  std::uint32_t limits = 0;    ///< !P !T
  std::uint32_t triggers = 0;  ///< #P #T $P $T
  std::uint32_t cables = 0;    ///< !D
};

/// One line without its end, its marks and its outer spaces. The texts live until the next push().
struct PtuLine {
  PtuLineKind kind = PtuLineKind::Garbled;
  std::string_view echo;     ///< what stood before the `*` or `!`
  std::string_view payload;  ///< what stood after it; the whole line when garbled
  PtuMarks marks;
  Stamp begun{};  ///< stamp of the `*` or `!`, else of the first byte
};

/// The longest line taken; a version text has about 100 characters.
inline constexpr std::size_t kPtuLineMax = 200;

/// Cuts what the unit sends into lines ended by CR, LF or both. Takes any byte.
class PtuReplyParser {
 public:
  /// The line that `byte`, stamped `stamp`, completes. A line with nothing but marks is returned as Success
  /// only if it has its `*`, else as Garbled with an empty payload; lines without anything are skipped.
  [[nodiscard]] std::optional<PtuLine> push(std::uint8_t byte, Stamp stamp) noexcept;

  /// Forgets an unfinished line.
  void clear() noexcept;

  /// Forgets an unfinished line but for the marks in it: they come without a line end.
  [[nodiscard]] PtuMarks cut() noexcept;

  [[nodiscard]] bool in_line() const noexcept { return size_ > 0 || overlong_; }

 private:
  [[nodiscard]] PtuLine finish() noexcept;

  std::array<char, kPtuLineMax> text_{};
  std::size_t size_ = 0;
  bool overlong_ = false;
  bool marked_ = false;  // a '*' was seen
  Stamp begun_{};
};

/// `text` as a decimal number of at most 15 digits with an optional sign and fraction; nothing else around
/// it.
[[nodiscard]] std::optional<double> ptu_number(std::string_view text) noexcept;

/// `text` as a position: a ptu_number without fraction, of magnitude at most 1e6.
[[nodiscard]] std::optional<std::int32_t> ptu_position(std::string_view text) noexcept;

/// What a number from the unit is about.
enum class PtuQuantity : std::uint8_t {
  Position,
  MinPosition,
  MaxPosition,
  Resolution,
  Speed,
  SpeedMin,
  SpeedMax,
  BaseSpeed,
  Acceleration,
};

/// A verbose result with a single number ("Current Pan position is 22").
struct PtuSentence {
  double value = 0.0;
  PtuQuantity quantity = PtuQuantity::Position;
  std::optional<Axis> axis;  ///< some firmware does not say it of the resolution
};

/// Reads a verbose result; nothing when it has no or several numbers, or does not say of what.
[[nodiscard]] std::optional<PtuSentence> ptu_sentence(std::string_view payload) noexcept;

/// Whether the two are the same but for the case of letters.
[[nodiscard]] bool ptu_same_text(std::string_view a, std::string_view b) noexcept;

}  // namespace slamsensor::hal
