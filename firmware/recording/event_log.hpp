#pragma once

#include <cstddef>
#include <cstdint>

namespace slamsensor::firmware {

/// The event log of LCM 1.3.1 (eventlog.c): per event, most significant byte first, the sync word, the
/// event's number (i64), its time (i64, us), the lengths of channel and data (i32 each), the channel without
/// a NUL, the data.
inline constexpr std::uint32_t kEventSync = 0xEDA1'DA01;
inline constexpr std::size_t kEventHeadBytes = 4 + 8 + 8 + 4 + 4;

/// LCM sends no longer channel names, nor none.
inline constexpr std::size_t kEventChannelMax = 63;

/// Larger events are neither written nor read: a map file is the largest that a recording holds.
inline constexpr std::size_t kEventDataMax = std::size_t{256} << 20;

}  // namespace slamsensor::firmware
