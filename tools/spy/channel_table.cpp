#include "tools/spy/channel_table.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::int64_t slot_of(hal::Stamp now, std::size_t slots) {
  return now / (ChannelTable::kWindow / static_cast<std::int64_t>(slots));
}

}  // namespace

void ChannelTable::add(const LcmMessageView& message, hal::Stamp now) {
  auto found = records_.find(message.channel);
  if (found == records_.end()) {
    if (records_.size() >= kChannelsMax) {
      ++left_out_;
      return;
    }
    found = records_.emplace(message.channel, ChannelRecord{}).first;
    histories_[found->first].first = now;
  }
  ChannelRecord& record = found->second;
  ++record.messages;
  record.bytes += message.bytes.size();
  record.last = now;
  record.last_bytes = message.bytes.size();
  const auto kept = message.bytes.first(std::min(message.bytes.size(), kKept));
  record.last_message.assign(kept.begin(), kept.end());

  const std::int64_t index = slot_of(now, kSlots);
  Slot& slot = histories_.find(message.channel)->second.slots[static_cast<std::size_t>(index) % kSlots];
  if (slot.index != index) {
    slot = {.index = index};
  }
  ++slot.messages;
  slot.bytes += message.bytes.size();
}

ChannelTable::Rate ChannelTable::rate(std::string_view name, hal::Stamp now) const {
  const auto found = histories_.find(name);
  if (found == histories_.end()) {
    return {};
  }
  const std::int64_t newest = slot_of(now, kSlots);
  const auto oldest = newest - static_cast<std::int64_t>(kSlots) + 1;
  Rate rate;
  for (const Slot& slot : found->second.slots) {
    if (slot.index >= oldest && slot.index <= newest) {
      rate.messages_hz += static_cast<double>(slot.messages);
      rate.bytes_per_s += static_cast<double>(slot.bytes);
    }
  }
  // The window ends inside a slot, so it begins where the oldest slot does.
  const hal::Stamp begin = oldest * (kWindow / static_cast<std::int64_t>(kSlots));
  const double seconds = std::max(0.5, hal::to_seconds(now - std::max(begin, found->second.first)));
  rate.messages_hz /= seconds;
  rate.bytes_per_s /= seconds;
  return rate;
}

}  // namespace slamsensor::tools
