#pragma once

#include "hal/stamp.hpp"
#include "tools/spy/lcm_receiver.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// What was heard on one channel.
struct ChannelRecord {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  hal::Stamp last{};                       ///< when the last message came
  std::size_t last_bytes = 0;              ///< its length
  std::vector<std::uint8_t> last_message;  ///< its first ChannelTable::kKept bytes
};

/// Every channel that was heard, by name. Times only grow.
class ChannelTable {
 public:
  static constexpr std::size_t kChannelsMax = 500;
  static constexpr std::size_t kKept = 8192;
  /// Rates are means over this time.
  static constexpr hal::Stamp kWindow = std::chrono::seconds(5);

  /// Counts `message`; a channel too many is counted in `left_out` alone.
  void add(const LcmMessageView& message, hal::Stamp now);

  [[nodiscard]] const std::map<std::string, ChannelRecord, std::less<>>& channels() const { return records_; }
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_; }

  struct Rate {
    double messages_hz = 0.0;
    double bytes_per_s = 0.0;
  };
  /// Of the channel `name` over the last kWindow before `now`, or since its first message if that is shorter.
  [[nodiscard]] Rate rate(std::string_view name, hal::Stamp now) const;

 private:
  // The window in slots of a tenth; a slot is that of `index` as long as it has not been used again.
  static constexpr std::size_t kSlots = 10;
  struct Slot {
    std::int64_t index = -1;
    std::uint64_t messages = 0;
    std::uint64_t bytes = 0;
  };
  struct History {
    hal::Stamp first{};
    std::array<Slot, kSlots> slots{};
  };

  std::map<std::string, ChannelRecord, std::less<>> records_;
  std::map<std::string, History, std::less<>> histories_;
  std::uint64_t left_out_ = 0;
};

/// The name of the LCM type of a message, by its fingerprint: "slamsensor.pose_t", "bot_core.pose_t", ...;
/// of an unknown one the fingerprint in hexadecimal, of fewer than 8 bytes "-".
[[nodiscard]] std::string lcm_type_text(std::span<const std::uint8_t> message);

/// A line "member  value" for each member of a message of a known type with fixed length; of an array as many
/// elements as fit some 60 characters. Empty for other types and for broken messages.
[[nodiscard]] std::vector<std::string> lcm_message_lines(std::span<const std::uint8_t> message);

}  // namespace slamsensor::tools
