#pragma once

#include "tools/spy/channel_table.hpp"
#include "tools/top/text_line.hpp"

namespace slamsensor::tools {

/// A line per LCM channel heard: name, type, rate, bandwidth, messages, time since the last, with number
/// `selected` marked; a heading above.
[[nodiscard]] TextLines channel_lines(const ChannelTable& table, std::size_t selected, hal::Stamp now);

/// The last message of channel number `selected`: its members when its type is known.
[[nodiscard]] TextLines message_lines(const ChannelTable& table, std::size_t selected);

}  // namespace slamsensor::tools
