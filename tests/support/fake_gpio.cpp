#include "tests/support/fake_gpio.hpp"

namespace slamsensor::tests {
namespace {

using hal::GpioEdges;
using hal::GpioLevel;
using hal::GpioPolarity;

constexpr std::size_t kEventsMax = 16;

GpioLevel level_of(Wire wire, GpioPolarity polarity) {
  return (wire == Wire::High) == (polarity == GpioPolarity::ActiveHigh) ? GpioLevel::Active
                                                                        : GpioLevel::Inactive;
}

Wire undriven(hal::GpioBias bias) {
  return bias == hal::GpioBias::PullUp ? Wire::High : Wire::Low;
}

}  // namespace

FakeGpioInput::FakeGpioInput(const FakeGpioConfig& config)
    : config_(config),
      wire_(undriven(config.bias)),
      debouncer_(config.debounce, level_of(wire_, config.polarity)) {
}

void FakeGpioInput::drive(Wire wire, hal::Stamp at) {
  if (wire == wire_) {
    return;
  }
  wire_ = wire;
  report(debouncer_.take({hal::edge_to(level_of(wire, config_.polarity)), at}));
  report(debouncer_.settle(at));
}

std::optional<GpioLevel> FakeGpioInput::level(hal::Stamp now) noexcept {
  if (is_gone_) {
    return std::nullopt;
  }
  report(debouncer_.settle(now));
  return debouncer_.settled();
}

std::optional<hal::GpioEvent> FakeGpioInput::next_event(hal::Stamp now) noexcept {
  if (is_gone_) {
    return std::nullopt;
  }
  report(debouncer_.settle(now));
  if (events_.empty()) {
    return std::nullopt;
  }
  const hal::GpioEvent event = events_.front();
  events_.pop_front();
  return event;
}

void FakeGpioInput::report(const std::optional<hal::GpioEvent>& event) {
  if (!event) {
    return;
  }
  const GpioEdges kind = event->edge == hal::GpioEdge::ToActive ? GpioEdges::ToActive : GpioEdges::ToInactive;
  if (config_.edges != GpioEdges::Both && config_.edges != kind) {
    return;
  }
  if (events_.size() == kEventsMax) {
    ++counters_[0].value;
  } else {
    events_.push_back(*event);
  }
}

Wire FakeGpioOutput::wire() const {
  const bool is_active = level_ == GpioLevel::Active;
  return is_active == (polarity_ == GpioPolarity::ActiveHigh) ? Wire::High : Wire::Low;
}

hal::GpioStatus FakeGpioOutput::set(GpioLevel level) noexcept {
  if (is_gone_) {
    return hal::GpioStatus::Failed;
  }
  level_ = level;
  return hal::GpioStatus::Ok;
}

}  // namespace slamsensor::tests
