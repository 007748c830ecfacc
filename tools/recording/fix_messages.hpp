#pragma once

#include "core/fix.hpp"
#include "core/landmark.hpp"
#include "firmware/config/config.hpp"
#include "firmware/lcm/lcm_publisher.hpp"
#include "firmware/output/geo_reference.hpp"
#include "firmware/recording/recorder.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <memory>
#include <optional>
#include <span>

namespace slamsensor::tools {

/// What an emulated sensor says of each scan, put into a recording as a live one's would be: its LCM
/// messages, which go nowhere else, and an epoch of NMEA.
class FixMessages final : private firmware::MessageTap {
 public:
  /// Both outlive the result. The error names the setting.
  [[nodiscard]] static tl::expected<std::unique_ptr<FixMessages>, WorldError> create(
      const firmware::Config& config, firmware::Recorder& recorder);

  /// Of a scan that was localised at `now`, which is UTC too.
  void write(const core::Fix& fix, std::span<const core::ScanLandmark> landmarks, hal::Stamp now);

 private:
  FixMessages(const firmware::Config& config, firmware::Recorder& recorder);
  void published(std::string_view channel, std::span<const std::uint8_t> bytes) noexcept override {
    recorder_.message(utime_us_, channel, bytes);
  }

  const firmware::Config& config_;
  firmware::Recorder& recorder_;
  std::int64_t utime_us_ = 0;                   // of what is written
  firmware::LcmSink sink_{firmware::LcmUrl{}};  // is never opened
  std::optional<firmware::LcmPublisher> publisher_;
  std::optional<firmware::GeoReference> geo_;
  std::optional<hal::Stamp> first_fix_;
};

}  // namespace slamsensor::tools
