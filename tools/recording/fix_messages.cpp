#include "tools/recording/fix_messages.hpp"

#include "firmware/output/nmea.hpp"

#include <array>
#include <utility>

namespace slamsensor::tools {

tl::expected<std::unique_ptr<FixMessages>, WorldError> FixMessages::create(const firmware::Config& config,
                                                                           firmware::Recorder& recorder) {
  std::unique_ptr<FixMessages> messages(new FixMessages(config, recorder));
  auto publisher = firmware::LcmPublisher::create(config.daemon.lcm, messages->sink_);
  if (!publisher) {
    return tl::unexpected(WorldError{publisher.error().message});
  }
  messages->publisher_ = std::move(*publisher);
  return messages;
}

FixMessages::FixMessages(const firmware::Config& config, firmware::Recorder& recorder)
    : config_(config), recorder_(recorder) {
  if (config.datum) {
    geo_.emplace(*config.datum);
  }
  sink_.set_tap(this);
}

void FixMessages::write(const core::Fix& fix, std::span<const core::ScanLandmark> landmarks, hal::Stamp now) {
  utime_us_ = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
  firmware::FixReport report;
  report.fix = fix;
  report.source = firmware::SourceMode::Emulated;
  report.monotonic = report.uptime = now;
  first_fix_ = fix.status == core::FixStatus::Fix && !first_fix_ ? now : first_fix_;
  report.time_to_first_fix = first_fix_;
  publisher_->publish(report);
  publisher_->publish(firmware::ScanView{report.initialization, fix.scan, fix.time, landmarks});
  std::array<char, firmware::kNmeaEpochBytesMax> epoch{};
  const auto context =
      firmware::nmea_context(config_.nmea, geo_ ? &*geo_ : nullptr, firmware::NmeaMode::Simulated);
  recorder_.nmea(utime_us_, {epoch.data(), firmware::format_nmea(fix, context, epoch)});
}

}  // namespace slamsensor::tools
