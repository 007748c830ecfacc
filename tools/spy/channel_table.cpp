#include "tools/spy/channel_table.hpp"

#include "firmware/lcm/lcm_messages.hpp"
#include "firmware/recording/event_log.hpp"
#include "tools/output/text_output.hpp"

#include <algorithm>
#include <cstdio>

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

namespace {

using firmware::LcmMessage;

constexpr std::size_t kArrayText = 60;

template <typename T>
void append_value(std::string& text, const T& value) {
  if constexpr (std::same_as<T, bool>) {
    text += value ? "yes" : "no";
  } else if constexpr (std::same_as<T, double>) {
    append_general(text, value, 10);
  } else {
    append_integer(text, static_cast<std::int64_t>(value));
  }
}

template <std::size_t kSize>
void append_value(std::string& text, const firmware::LcmText<kSize>& value) {
  const std::string_view shown = firmware::text_of(value);
  text += '"';
  std::transform(shown.begin(), shown.end(), std::back_inserter(text),
                 [](char c) { return c >= ' ' && c <= '~' ? c : '?'; });
  text += '"';
}

template <typename T, std::size_t kCount>
void append_value(std::string& text, const std::array<T, kCount>& values) {
  const std::size_t begin = text.size();
  for (std::size_t i = 0; i < kCount; ++i) {
    if (text.size() - begin > kArrayText) {
      text += " ...";
      return;
    }
    text += i == 0 ? "" : " ";
    append_value(text, values[i]);
  }
}

template <LcmMessage T>
std::vector<std::string> lines_of(std::span<const std::uint8_t> bytes) {
  std::vector<std::string> lines;
  if (const auto message = firmware::decode_lcm<T>(bytes)) {
    T::members(*message, [&lines](std::string_view name, const auto& member) {
      std::string line(name);
      line.resize(std::max<std::size_t>(line.size() + 1, 24), ' ');
      append_value(line, member);
      lines.push_back(std::move(line));
    });
  }
  return lines;
}

std::vector<std::string> no_lines(std::span<const std::uint8_t> /*bytes*/) {
  return {};
}

struct KnownType {
  std::uint64_t fingerprint;
  std::string_view name;
  std::vector<std::string> (*lines)(std::span<const std::uint8_t>);
};

template <LcmMessage T>
constexpr KnownType known(std::string_view name) {
  return {firmware::kLcmFingerprint<T>, name, lines_of<T>};
}

// The last one is libbot's, of planar scanners, known to the robots that this sensor meets.
constexpr std::array kKnown = {
    known<firmware::PoseMessage>("slamsensor.pose_t"),
    known<firmware::StatusMessage>("slamsensor.status_t"),
    known<firmware::CountersMessage>("slamsensor.counters_t"),
    known<firmware::MapMessage>("slamsensor.map_t"),
    known<firmware::ScanMessage>("slamsensor.scan_t"),
    known<firmware::RivalsMessage>("slamsensor.rivals_t"),
    known<firmware::BotCorePose>("bot_core.pose_t"),
    KnownType{firmware::kBlockFingerprint, "slamsensor.block_t", no_lines},
    KnownType{firmware::kTextFingerprint, "slamsensor.text_t", no_lines},
    KnownType{
        firmware::lcm_fingerprint({{"utime", "int64_t", ""},
                                   {"nranges", "int32_t", ""},
                                   {"ranges", "float", "nranges", firmware::LcmArray::ByMember},
                                   {"nintensities", "int32_t", ""},
                                   {"intensities", "float", "nintensities", firmware::LcmArray::ByMember},
                                   {"rad0", "float", ""},
                                   {"radstep", "float", ""}}),
        "bot_core.planar_lidar_t", no_lines},
};

const KnownType* find(std::uint64_t fingerprint) {
  const auto found = std::find_if(kKnown.begin(), kKnown.end(),
                                  [&](const KnownType& type) { return type.fingerprint == fingerprint; });
  return found == kKnown.end() ? nullptr : &*found;
}

}  // namespace

std::string lcm_type_text(std::span<const std::uint8_t> message) {
  const auto fingerprint = firmware::lcm_fingerprint_in(message);
  if (!fingerprint) {
    return "-";
  }
  if (const KnownType* type = find(*fingerprint)) {
    return std::string(type->name);
  }
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(*fingerprint));
  return text;
}

std::vector<std::string> lcm_message_lines(std::span<const std::uint8_t> message) {
  const auto fingerprint = firmware::lcm_fingerprint_in(message);
  const KnownType* type = fingerprint ? find(*fingerprint) : nullptr;
  return type != nullptr ? type->lines(message) : std::vector<std::string>{};
}

}  // namespace slamsensor::tools
