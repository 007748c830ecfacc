#pragma once

#include "hal/pantilt/canopen/canopen_objects.hpp"
#include "hal/transport/can_link.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace slamsensor::hal {

/// The frame that writes the low `size` bytes (1 to 4) of `value` (expedited download, CiA 301).
[[nodiscard]] CanFrame sdo_write(std::uint8_t node, SdoAddress address, std::uint32_t value,
                                 std::uint8_t size) noexcept;

/// The frame that asks for a value (upload).
[[nodiscard]] CanFrame sdo_read(std::uint8_t node, SdoAddress address) noexcept;

/// The frame that asks for the next segment; `toggle` is 0 for the first, then 1, 0, ...
[[nodiscard]] CanFrame sdo_read_segment(std::uint8_t node, std::uint8_t toggle) noexcept;

/// The frame by which the client gives a transfer up.
[[nodiscard]] CanFrame sdo_abort(std::uint8_t node, SdoAddress address, std::uint32_t code) noexcept;

/// The frame of a network management command to `node`; 0 is all nodes.
[[nodiscard]] CanFrame nmt_frame(NmtCommand command, std::uint8_t node) noexcept;

enum class SdoReplyKind : std::uint8_t {
  Written,
  Value,      ///< expedited upload: `value`, `size`
  LongValue,  ///< a segmented upload begins; `value` is its length in bytes where told, else 0
  Segment,    ///< `bytes`, `size`, `toggle`, `last`
  Abort,      ///< `value` is the code
};

struct SdoReply {
  SdoReplyKind kind = SdoReplyKind::Abort;
  SdoAddress address;  ///< not of a Segment, which carries none
  std::uint32_t value = 0;
  std::uint8_t size = 0;  ///< bytes of `value` or of `bytes`
  std::uint8_t toggle = 0;
  bool last = false;
  std::array<std::uint8_t, 7> bytes{};
};

/// What the 8 bytes of a server's reply say; nothing when they have another length or an unknown command.
[[nodiscard]] std::optional<SdoReply> parse_sdo_reply(const CanFrame& frame) noexcept;

/// The little-endian number in `size` (at most 4) bytes of `frame` from `offset` on; 0 where it has none.
[[nodiscard]] std::uint32_t le_number(const CanFrame& frame, std::size_t offset, std::size_t size) noexcept;

/// Writes `size` (at most 4) bytes of `value` into `frame` at `offset`, as far as it has room.
void put_le(CanFrame& frame, std::size_t offset, std::size_t size, std::uint32_t value) noexcept;

}  // namespace slamsensor::hal
