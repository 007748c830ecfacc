#include "tools/emulator/in_process_head.hpp"

#include "tools/emulator/make_head_devices.hpp"
#include "tools/emulator/scenario.hpp"

#include <utility>

namespace slamsensor::tools {
namespace {

std::unique_ptr<MemoryLink> byte_link(EmulatedPort* port, const SimClock& clock, std::uint32_t baud,
                                      double usb_s) {
  MemoryLinkConfig config;
  config.baud = baud;
  config.batch = hal::from_seconds(usb_s);
  return port != nullptr ? std::make_unique<MemoryLink>(*port, clock, config) : nullptr;
}

std::unique_ptr<MemoryCanLink> can_link(const EmulatedPort* port, MemoryCanBus* bus, const SimClock& clock) {
  return port == nullptr && bus != nullptr ? std::make_unique<MemoryCanLink>(*bus, clock) : nullptr;
}

}  // namespace

tl::expected<std::unique_ptr<InProcessHead>, WorldError> InProcessHead::create(const Scenario& scenario) {
  return create(scenario, make_head_devices);
}

tl::expected<std::unique_ptr<InProcessHead>, WorldError> InProcessHead::create(const Scenario& scenario,
                                                                               const DeviceMaker& make) {
  return EmulatedHead::create(scenario, make).map([&](std::unique_ptr<EmulatedHead> head) {
    return std::unique_ptr<InProcessHead>(new InProcessHead(std::move(head), scenario));
  });
}

InProcessHead::InProcessHead(std::unique_ptr<EmulatedHead> head, const Scenario& scenario)
    : head_(std::move(head)) {
  const PtuProfile& ptu = scenario.head.ptu;
  const RangefinderProfile& finder = scenario.head.rangefinder;
  const SimClock& clock = head_->clock();
  ptu_bytes_ = byte_link(head_->ptu_port(), clock, ptu.baud, ptu.usb_s);
  ptu_can_ = can_link(head_->ptu_port(), head_->bus(), clock);
  rangefinder_bytes_ = byte_link(head_->rangefinder_port(), clock, finder.baud, finder.usb_s);
  rangefinder_can_ = can_link(head_->rangefinder_port(), head_->bus(), clock);
}

}  // namespace slamsensor::tools
