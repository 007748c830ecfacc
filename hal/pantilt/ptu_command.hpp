#pragma once

#include "hal/pantilt/ptu_config.hpp"
#include "hal/pantilt/ptu_reply.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::hal {

/// What must come back.
enum class PtuExpect : std::uint8_t {
  Done,      ///< `*` alone
  Setting,   ///< `*`, and words where the firmware likes to say what it did
  Position,  ///< a whole number, or a sentence with the position of the axis
  Number,    ///< a number, or a sentence with the quantity of the axis
  Version,   ///< words that are no number: the marker that shows which reply belongs to what
};

/// One command as it goes on the line, and what its answer must look like (PTU-D46 User's Manual, "Command
/// syntax"). A value.
class PtuCommand {
 public:
  /// Nothing.
  PtuCommand() noexcept = default;

  /// `verb` (at most 8 characters) without argument.
  PtuCommand(std::string_view verb, PtuExpect expect) noexcept;

  /// `verb` with a whole number.
  PtuCommand(std::string_view verb, std::int32_t argument, PtuExpect expect) noexcept;

  /// The query of a quantity of an axis: PP, PN, PX, PR, PS, PL, PU, PB, PA or their T twins.
  [[nodiscard]] static PtuCommand query(Axis axis, PtuQuantity quantity) noexcept;

  /// The absolute target position ("PP-2500").
  [[nodiscard]] static PtuCommand target(Axis axis, std::int32_t position) noexcept;

  /// The desired speed, positions/s ("PS1000").
  [[nodiscard]] static PtuCommand speed(Axis axis, std::int32_t positions_ps) noexcept;

  /// The change of the host line's rate until power is off ("@(38400,0,F)").
  [[nodiscard]] static PtuCommand baud(std::uint32_t rate) noexcept;

  /// The command without its delimiter: what an echo looks like.
  [[nodiscard]] std::string_view text() const noexcept { return {text_.data(), size_}; }
  [[nodiscard]] PtuExpect expect() const noexcept { return expect_; }
  [[nodiscard]] Axis axis() const noexcept { return axis_; }
  [[nodiscard]] PtuQuantity quantity() const noexcept { return quantity_; }

  /// Writes the command and its delimiter into `into`; returns the bytes written.
  [[nodiscard]] std::size_t write(std::span<std::uint8_t> into) const noexcept;

 private:
  void append(std::string_view more) noexcept;
  void append_number(std::int64_t number) noexcept;

  std::array<char, 23> text_{};
  std::size_t size_ = 0;
  PtuExpect expect_ = PtuExpect::Done;
  Axis axis_ = Axis::Pan;
  PtuQuantity quantity_ = PtuQuantity::Position;
};

/// What write() needs at most.
inline constexpr std::size_t kPtuCommandMax = 24;

/// What a reply says as the answer to a command.
struct PtuMatch {
  double value = 0.0;    ///< of a Position or Number
  bool verbose = false;  ///< a sentence came where a terse unit sends a number
};

/// Takes `payload` of a Success line as the answer to `command`; nothing when it cannot be.
[[nodiscard]] std::optional<PtuMatch> ptu_match(const PtuCommand& command, std::string_view payload) noexcept;

}  // namespace slamsensor::hal
