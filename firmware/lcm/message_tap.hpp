#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

/// Is told every LCM message that the sensor publishes, in order, whether the network took it or not: a
/// recording hears the same without a network.
class MessageTap {
 public:
  MessageTap() = default;
  MessageTap(const MessageTap&) = delete;
  MessageTap& operator=(const MessageTap&) = delete;
  virtual ~MessageTap() = default;

  /// `channel` has 1 to 63 characters; both views end with the call. On the thread that publishes.
  virtual void published(std::string_view channel, std::span<const std::uint8_t> bytes) noexcept = 0;
};

}  // namespace slamsensor::firmware
