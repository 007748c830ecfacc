#include "firmware/daemon/inclination_loop.hpp"

#include "firmware/scan/scan_scheduler.hpp"

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kReportPeriod = std::chrono::milliseconds(100);

}  // namespace

tl::expected<std::unique_ptr<InclinationLoop>, std::string> InclinationLoop::create(const Config& config) {
  auto opened = open_inclinometer(config.head, config.scan_head.levelling.source);
  if (!opened) {
    return tl::unexpected("inclination: " + opened.error().message);
  }
  if (opened->device == nullptr) {
    return nullptr;
  }
  return std::unique_ptr<InclinationLoop>(new InclinationLoop(std::move(*opened)));
}

void InclinationLoop::step(hal::Stamp now) noexcept {
  hal::Inclinometer& device = *inclinometer_.device;
  device.step(now);
  watch_.step(device.state(), device.problem(), now);
  const auto measured = device.take();
  if (!measured && now - posted_ < kReportPeriod) {
    return;
  }
  latest_ = measured ? measured : latest_;
  posted_ = now;
  InclinationReport& report = reports_.draft();
  watch_.report(device, report.device);
  report.device.model = device.model();
  report.latest = latest_;
  reports_.post();
}

std::optional<InclinationFeed::Order> InclinationFeed::step(hal::Stamp now) noexcept {
  if (reports_.refresh() && reports_.value().latest && reports_.value().latest->stamp > told_ &&
      now - reports_.value().latest->stamp <= max_age_) {
    const hal::Inclination& latest = *reports_.value().latest;
    known_ = told_ = latest.stamp;
    return Order{TapeCommand::Incline, pack_inclination(latest.roll_rad, latest.pitch_rad)};
  }
  if (known_ && now - *known_ > max_age_) {
    known_.reset();
    return Order{TapeCommand::Hold, static_cast<std::uint64_t>(HoldReason::LeanUnknown)};
  }
  return std::nullopt;
}

}  // namespace slamsensor::firmware
