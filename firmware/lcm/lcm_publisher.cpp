#include "firmware/lcm/lcm_publisher.hpp"

namespace slamsensor::firmware {
namespace {

constexpr std::array<std::string_view, 6> kNames = {"POSE", "STATUS", "COUNTERS", "MAP", "SCAN", "RIVALS"};
constexpr std::string_view kLongestName = kNames[2];

bool is_printable(std::string_view text) noexcept {
  return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

hal::InitError refused(std::string_view key, std::string_view value, std::size_t longest) {
  return {std::string(key) + " is \"" + std::string(value) + "\": a name of at most " +
          std::to_string(longest) + " printable characters without spaces is needed"};
}

}  // namespace

tl::expected<LcmPublisher, hal::InitError> LcmPublisher::create(const LcmConfig& config, LcmSink& sink) {
  constexpr std::size_t kPrefixMax = kLcmChannelMax - kLongestName.size();
  if (config.prefix.size() > kPrefixMax || !is_printable(config.prefix)) {
    return tl::unexpected(refused("lcm.prefix", config.prefix, kPrefixMax));
  }
  if (config.bot_core_channel.size() > kLcmChannelMax || !is_printable(config.bot_core_channel)) {
    return tl::unexpected(refused("lcm.bot_core_channel", config.bot_core_channel, kLcmChannelMax));
  }
  for (const std::string_view name : kNames) {
    if (config.bot_core_channel == config.prefix + std::string(name)) {
      return tl::unexpected(hal::InitError{"lcm.bot_core_channel is \"" + config.bot_core_channel +
                                           "\", which is a channel of lcm.prefix too: change one of them"});
    }
  }
  return LcmPublisher(config, sink);
}

LcmPublisher::LcmPublisher(const LcmConfig& config, LcmSink& sink) noexcept
    : sink_(&sink),
      pose_(config.prefix, kNames[0]),
      status_(config.prefix, kNames[1]),
      counters_(config.prefix, kNames[2]),
      map_(config.prefix, kNames[3]),
      scan_(config.prefix, kNames[4]),
      rivals_(config.prefix, kNames[5]),
      bot_core_(config.bot_core_channel) {
}

void LcmPublisher::send(const LcmChannel& channel, std::size_t bytes) noexcept {
  sink_->publish(channel, {buffer_.data(), bytes});
}

void LcmPublisher::publish(const FixReport& report) noexcept {
  send(pose_, encode_pose(report, buffer_));
  if (const std::size_t bytes = encode_bot_core_pose(report, buffer_); bytes != 0 && !bot_core_.empty()) {
    send(bot_core_, bytes);
  }
}

void LcmPublisher::publish(const SensorStatus& status, hal::Stamp utc) noexcept {
  send(status_, encode_status(status, utc, buffer_));
  for (std::size_t station = 0; station < kLcmStationNames.size(); ++station) {
    for (std::size_t part = 0; part < kLcmCounterParts; ++part) {
      const std::size_t bytes = encode_counters(status, utc, static_cast<LcmStation>(station), part, buffer_);
      if (bytes != 0) {
        send(counters_, bytes);
      }
    }
  }
}

void LcmPublisher::publish(const LcmRivalsView& rivals) noexcept {
  if (const std::size_t bytes = encode_rivals(rivals, buffer_); bytes != 0) {
    send(rivals_, bytes);
  }
}

void LcmPublisher::publish(const LcmScanView& scan) noexcept {
  for (std::uint32_t chunk = 0; chunk < scan_chunks(scan); ++chunk) {
    send(scan_, encode_scan_chunk(scan, chunk, buffer_));
  }
}

std::optional<std::uint32_t> LcmPublisher::publish(const LcmMapView& map, std::uint32_t first,
                                                   std::uint32_t at_most) noexcept {
  const std::uint32_t chunks = map_chunks(map);
  const std::uint32_t begin = std::min(first, chunks);
  const std::uint32_t end = begin + std::min(at_most, chunks - begin);
  for (std::uint32_t chunk = begin; chunk < end; ++chunk) {
    send(map_, encode_map_chunk(map, chunk, buffer_));
  }
  return end < chunks ? std::optional(end) : std::nullopt;
}

}  // namespace slamsensor::firmware
