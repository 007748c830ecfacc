#pragma once

#include "firmware/recording/tape_format.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace slamsensor::tools {

/// One operation of a tape; which of its values count depends on `op` (firmware/recording/tape_format.hpp).
struct TapeOperation {
  firmware::TapeOp op = firmware::TapeOp::End;
  firmware::HeadLink link{};
  hal::LinkStatus status = hal::LinkStatus::Busy;
  hal::Stamp time{};  ///< of a step, or the stamp of what was read or received
  firmware::TapeLinkState state;
  hal::CanFrame frame;
  std::span<const std::uint8_t> bytes;  ///< in the chunk
  std::uint32_t baud = 0;
  firmware::TapeCommand command{};
  std::uint64_t number = 0;  ///< argument of a command, or operations lost
};

/// Takes the chunks of a tape apart, in their order. Every number is held against its bounds.
class TapeReader {
 public:
  /// Goes on with `chunk`, which stays until the next one.
  void load(std::span<const std::uint8_t> chunk) noexcept;

  /// The next operation; nothing at the end of the chunk, and from the first byte on that is no operation.
  [[nodiscard]] std::optional<TapeOperation> next() noexcept;

  /// Whether the chunk has a byte that is no operation.
  [[nodiscard]] bool is_broken() const noexcept { return is_broken_; }

 private:
  using Operation = std::optional<TapeOperation>;
  [[nodiscard]] Operation step(TapeOperation operation) noexcept;
  [[nodiscard]] Operation fields(TapeOperation operation) noexcept;
  [[nodiscard]] bool take_state(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_stamp(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_status(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_bytes(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_frame(TapeOperation& operation) noexcept;
  [[nodiscard]] bool take_command(TapeOperation& operation) noexcept;
  [[nodiscard]] std::optional<std::uint64_t> number(std::uint64_t max) noexcept;
  [[nodiscard]] std::optional<std::int64_t> signed_number() noexcept;

  std::span<const std::uint8_t> rest_;
  hal::Stamp now_{};
  hal::Stamp period_{};
  bool is_first_step_ = true;
  bool is_broken_ = false;
};

}  // namespace slamsensor::tools
