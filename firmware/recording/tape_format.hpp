#pragma once

#include "hal/transport/can_link.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

/// A tape holds everything that the drivers and the scan scheduler got from the outer world, in the order
/// in which they got it: each call of step() with its time, each call of a link with its result, each
/// command. Drivers that are made anew and given the same answers again do the same again, bit for bit.
///
/// An operation is one byte, `TapeOp` in the upper four bits and the number of the link in the lower four,
/// then its fields: numbers as LEB128 (signed ones zigzag), bytes as they are. "State" stands for epoch, 1
/// when up else 0, baud (0 on a bus).
///   Open         state                                  before the driver is made
///   Step         ns since the step before, less those between it and its predecessor (signed); the first
///                step of a chunk: ns since boot
///   Service      state                                  when service() has changed it
///   After        state                                  when the operation before has changed it
///   ReadBusy     -                                      of a bus too
///   ReadDown     -                                      of a bus too
///   ReadOk       stamp - now (signed ns), count, bytes
///   Write        status, count, bytes
///   SetBaud      status, baud
///   Discard      -
///   CanReceive   stamp - now (signed ns), id, extended + 2 * size, bytes
///   CanSend      status, id, extended + 2 * size, bytes
///   Command      TapeCommand, its argument
///   Lost         operations that found no room          the tape cannot be played any further
///   End          -                                      the recording was ended in good order
enum class TapeOp : std::uint8_t {
  Open,
  Step,
  Service,
  After,
  ReadBusy,
  ReadDown,
  ReadOk,
  Write,
  SetBaud,
  Discard,
  CanReceive,
  CanSend,
  Command,
  Lost,
  End,
};

inline constexpr std::size_t kTapeOps = static_cast<std::size_t>(TapeOp::End) + 1;
inline constexpr std::size_t kTapeLinks = 16;

/// The links of a sensor head on its tape.
enum class HeadLink : std::uint8_t { PanTiltBytes, PanTiltCan, RangefinderBytes, RangefinderCan };
inline constexpr std::array<std::string_view, 4> kHeadLinkNames = {
    "pan-tilt port", "pan-tilt CAN socket", "rangefinder port", "rangefinder CAN socket"};

[[nodiscard]] constexpr bool is_bus(HeadLink link) noexcept {
  return link == HeadLink::PanTiltCan || link == HeadLink::RangefinderCan;
}

/// What else than time and devices leads a scan. The argument is 0 where none is named.
enum class TapeCommand : std::uint8_t {
  RequestScan,
  Hold,     ///< argument: the reason's number
  Release,  ///< argument: the reason's number
  SetMode,  ///< argument: the ScanMode's number
  AbortScan,
  Incline,  ///< argument: see pack_inclination()
};
inline constexpr std::size_t kTapeCommands = static_cast<std::size_t>(TapeCommand::Incline) + 1;

/// Roll (upper half) and pitch (lower half) as floats, rad: the argument of TapeCommand::Incline.
[[nodiscard]] constexpr std::uint64_t pack_inclination(double roll_rad, double pitch_rad) noexcept {
  return std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(roll_rad))} << 32U |
         std::bit_cast<std::uint32_t>(static_cast<float>(pitch_rad));
}

/// What a link says of itself.
struct TapeLinkState {
  std::uint32_t epoch = 0;
  bool is_up = false;
  std::uint32_t baud = 0;

  friend bool operator==(const TapeLinkState&, const TapeLinkState&) = default;
};

/// Most bytes that one read of a recorded link hands out. A longer write is cut on the tape, which then plays
/// as far as that.
inline constexpr std::size_t kTapeBytesMax = 8192;

/// Most bytes of a chunk: an LCM message that carries it is a single datagram.
inline constexpr std::size_t kTapeChunkBytes = std::size_t{32} * 1024;

/// A piece of tape: whole operations. Chunks are numbered from 0; one that is missing shows.
struct TapeChunk {
  std::uint64_t number = 0;
  std::uint32_t size = 0;
  std::array<std::uint8_t, kTapeChunkBytes> data;

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return {data.data(), size}; }
};

/// Takes full chunks off a tape's writer, on the writer's thread.
class TapeSink {
 public:
  TapeSink() = default;
  TapeSink(const TapeSink&) = delete;
  TapeSink& operator=(const TapeSink&) = delete;
  virtual ~TapeSink() = default;

  /// Copies `chunk`; false, and nothing is kept, when there is no room. Waits for nothing.
  [[nodiscard]] virtual bool take(const TapeChunk& chunk) noexcept = 0;
};

}  // namespace slamsensor::firmware
