#pragma once

#include "firmware/config/daemon_config.hpp"
#include "firmware/lcm/lcm_messages.hpp"
#include "firmware/lcm/lcm_sink.hpp"

#include <algorithm>
#include <optional>

namespace slamsensor::firmware {

/// The LCM output of the daemon: what is sent on which channel. One thread, that of the sink. Nothing
/// allocates while the sink is open, once the process has sent its first message.
///
///   PREFIXPOSE      slamsensor.pose_t
///   PREFIXSTATUS    slamsensor.status_t
///   PREFIXCOUNTERS  slamsensor.counters_t
///   PREFIXMAP       slamsensor.map_t, in chunks
///   PREFIXSCAN      slamsensor.scan_t, in chunks
///   PREFIXRIVALS    slamsensor.rivals_t, of an ambiguous scan alone
///   bot_core_channel   bot_core.pose_t, of a fix alone; none when its name is empty
class LcmPublisher {
 public:
  /// The error names lcm.prefix or lcm.bot_core_channel: a channel has 1 to 63 printable characters.
  [[nodiscard]] static tl::expected<LcmPublisher, hal::InitError> create(const LcmConfig& config,
                                                                         LcmSink& sink);

  /// Sends the pose, and bot_core's when it is a fix.
  void publish(const FixReport& report) noexcept;

  /// Sends the status and the counters of every station.
  void publish(const SensorStatus& status, hal::Stamp utc) noexcept;

  /// Sends the rivals, if there are any.
  void publish(const LcmRivalsView& rivals) noexcept;

  /// Sends every chunk of the scan.
  void publish(const LcmScanView& scan) noexcept;

  /// Sends at most `at_most` chunks of the map from number `first` on; returns the number of the first one
  /// not sent yet, none when the map is sent. A large map is spread over several calls, for receivers that
  /// have little room.
  [[nodiscard]] std::optional<std::uint32_t> publish(const LcmMapView& map, std::uint32_t first,
                                                     std::uint32_t at_most) noexcept;

 private:
  explicit LcmPublisher(const LcmConfig& config, LcmSink& sink) noexcept;
  void send(const LcmChannel& channel, std::size_t bytes) noexcept;

  static constexpr std::size_t kBytesMax = std::max(
      {kLcmBytes<PoseMessage>, kLcmBytes<BotCorePose>, kLcmBytes<StatusMessage>, kLcmBytes<CountersMessage>,
       kLcmBytes<MapMessage>, kLcmBytes<ScanMessage>, kLcmBytes<RivalsMessage>});
  // With the channel and LCM's header every message fits one datagram in one Ethernet frame.
  static_assert(kBytesMax + 8 + kLcmChannelMax + 1 <= 1472);

  LcmSink* sink_;
  LcmChannel pose_;
  LcmChannel status_;
  LcmChannel counters_;
  LcmChannel map_;
  LcmChannel scan_;
  LcmChannel rivals_;
  LcmChannel bot_core_;
  std::array<std::uint8_t, kBytesMax> buffer_{};
};

}  // namespace slamsensor::firmware
