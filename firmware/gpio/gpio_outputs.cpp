#include "firmware/gpio/gpio_outputs.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kAbsentHalf = std::chrono::milliseconds(500);  // 1 Hz
constexpr hal::Stamp kHeldHalf = std::chrono::milliseconds(125);    // 4 Hz

/// Half a period of the LED; zero when it is steady.
constexpr hal::Stamp blink_half(SensorState state) noexcept {
  switch (state) {
    case SensorState::Starting:
    case SensorState::Faulted:
      return kAbsentHalf;
    case SensorState::Held:
      return kHeldHalf;
    case SensorState::Scanning:
    case SensorState::Fixed:
    case SensorState::Ambiguous:
    case SensorState::Lost:
      break;
  }
  return {};
}

constexpr hal::GpioLevel led_level(SensorState state, hal::Stamp now) noexcept {
  const hal::Stamp half = blink_half(state);
  const bool lit = half > hal::Stamp{} ? now / half % 2 == 0 : state == SensorState::Fixed;
  return lit ? hal::GpioLevel::Active : hal::GpioLevel::Inactive;
}

}  // namespace

GpioOutputs::GpioOutputs(GpioOutputLines lines, hal::Stamp pulse) noexcept
    : lines_(std::move(lines)),
      pulse_(pulse),
      counters_({"pulses_begun", "pulses_joined", "led_failed", "pulse_failed"}) {
}

GpioOutputs::~GpioOutputs() {
  set(lines_.led.get(), hal::GpioLevel::Inactive, GpioOutputEvent::LedFailed);
  set(lines_.pulse.get(), hal::GpioLevel::Inactive, GpioOutputEvent::PulseFailed);
}

void GpioOutputs::on_fix(hal::Stamp now) noexcept {
  if (lines_.pulse == nullptr) {
    return;
  }
  counters_.count(now < pulse_end_ ? GpioOutputEvent::PulsesJoined : GpioOutputEvent::PulsesBegun);
  pulse_end_ = now + pulse_;
  set(lines_.pulse.get(), hal::GpioLevel::Active, GpioOutputEvent::PulseFailed);
}

void GpioOutputs::step(SensorState state, hal::Stamp now) noexcept {
  state_ = state;
  set(lines_.led.get(), led_level(state, now), GpioOutputEvent::LedFailed);
  set(lines_.pulse.get(), now < pulse_end_ ? hal::GpioLevel::Active : hal::GpioLevel::Inactive,
      GpioOutputEvent::PulseFailed);
}

hal::Stamp GpioOutputs::next_change(hal::Stamp now) const noexcept {
  hal::Stamp next = hal::kNever;
  if (lines_.pulse != nullptr && now < pulse_end_) {
    next = pulse_end_;
  }
  const hal::Stamp half = blink_half(state_);
  if (lines_.led != nullptr && half > hal::Stamp{}) {
    next = std::min(next, (now / half + 1) * half);
  }
  return next;
}

/// Tells a line only what it was not told yet.
void GpioOutputs::set(hal::GpioOutput* line, hal::GpioLevel level, GpioOutputEvent failure) noexcept {
  if (line != nullptr && line->level() != level && line->set(level) == hal::GpioStatus::Failed) {
    counters_.count(failure);
  }
}

}  // namespace slamsensor::firmware
