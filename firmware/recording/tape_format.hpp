#pragma once

#include "firmware/lcm/fingerprint.hpp"
#include "hal/transport/can_link.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamsensor::firmware {

/// A tape holds everything that drivers were told by the outer world, in the order in which they were told:
/// each call of step() with its time, and each call of a link with its result. Drivers that are given the
/// same answers again do the same again, bit for bit.
///
/// A chunk of tape is a sequence of operations. An operation is one byte, `TapeOp` in the upper four bits and
/// the number of the link in the lower four, then its fields: numbers as LEB128 (signed ones zigzag), bytes
/// as they are.
///   Step          ns since the step before; in the first step of a chunk, since boot
///   LinkState     epoch, 1 when up else 0         (when service() changed it)
///   ReadBusy      -
///   ReadOk        stamp - now (signed ns), count, bytes
///   ReadDown      epoch, up
///   Write         status, count, bytes
///   SetBaud       status, baud
///   Discard       -
///   CanReceive    stamp - now (signed ns), id, extended + 2 * size, bytes
///   CanSend       status, id, extended + 2 * size, bytes
enum class TapeOp : std::uint8_t {
  Step,
  LinkState,
  ReadBusy,
  ReadOk,
  ReadDown,
  Write,
  SetBaud,
  Discard,
  CanReceive,
  CanSend,
};

inline constexpr std::size_t kTapeOps = static_cast<std::size_t>(TapeOp::CanSend) + 1;
inline constexpr std::size_t kTapeLinks = 16;

/// Most bytes that one read or write of a link can carry; longer calls are recorded as far as that, and the
/// tape is marked broken.
inline constexpr std::size_t kTapeBytesMax = 8192;

/// A chunk ends at the first step after this many bytes, so that an LCM message stays below 64 kB.
inline constexpr std::size_t kTapeChunkBytes = 32 * 1024;

/// The LCM type that carries a chunk: `struct tape_t { int64_t utime; int64_t chunk; int32_t size; byte
/// data[size]; }`.
inline constexpr std::string_view kTapeChannel = "SLAMSENSOR_TAPE";
inline constexpr std::uint64_t kTapeFingerprint =
    lcm_fingerprint({{"utime", "int64_t", ""},
                     {"chunk", "int64_t", ""},
                     {"size", "int32_t", ""},
                     {"data", "byte", "size", LcmArray::ByMember}});

/// The LCM type that carries the configuration in force as TOML: `struct text_t { int64_t utime; string text;
/// }`.
inline constexpr std::string_view kConfigChannel = "SLAMSENSOR_CONFIG";
inline constexpr std::uint64_t kTextFingerprint =
    lcm_fingerprint({{"utime", "int64_t", ""}, {"text", "string", ""}});

}  // namespace slamsensor::firmware
