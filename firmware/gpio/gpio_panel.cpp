#include "firmware/gpio/gpio_panel.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr int kEdgesMax = 16;  // taken in one poll: what the kernel keeps

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

constexpr hal::GpioPolarity polarity_of(GpioPolaritySetting setting) noexcept {
  return setting == GpioPolaritySetting::ActiveHigh ? hal::GpioPolarity::ActiveHigh
                                                    : hal::GpioPolarity::ActiveLow;
}

constexpr hal::GpioBias bias_of(GpioBiasSetting setting) noexcept {
  switch (setting) {
    case GpioBiasSetting::AsIs:
      break;
    case GpioBiasSetting::Disabled:
      return hal::GpioBias::Disabled;
    case GpioBiasSetting::PullUp:
      return hal::GpioBias::PullUp;
    case GpioBiasSetting::PullDown:
      return hal::GpioBias::PullDown;
  }
  return hal::GpioBias::AsIs;
}

hal::InitError named(std::string_view setting, const hal::InitError& error) {
  return {std::string(setting) + ": " + error.message};
}

/// The input of `setting`; null when it names no chip.
tl::expected<std::unique_ptr<hal::GpioInput>, hal::InitError> open_input(const GpioInputSetting& setting,
                                                                         hal::GpioEdges edges,
                                                                         std::string_view name,
                                                                         const GpioOpeners& openers) {
  if (setting.chip.empty()) {
    return nullptr;
  }
  hal::GpioInputConfig config;
  config.address = {setting.chip, std::to_string(setting.line)};
  config.polarity = polarity_of(setting.polarity);
  config.bias = bias_of(setting.bias);
  config.edges = edges;
  config.debounce = hal::from_seconds(setting.debounce_s);
  return openers.input(config).map_error([&](const hal::InitError& error) { return named(name, error); });
}

tl::expected<std::unique_ptr<hal::GpioOutput>, hal::InitError> open_output(const GpioOutputSetting& setting,
                                                                           std::string_view name,
                                                                           const GpioOpeners& openers) {
  if (setting.chip.empty()) {
    return nullptr;
  }
  hal::GpioOutputConfig config;
  config.address = {setting.chip, std::to_string(setting.line)};
  config.polarity = polarity_of(setting.polarity);
  return openers.output(config).map_error([&](const hal::InitError& error) { return named(name, error); });
}

}  // namespace

GpioInputs::GpioInputs(GpioInputLines lines) noexcept
    : lines_(std::move(lines)), counters_({"trigger_edges", "interlock_openings", "interlock_lost"}) {
}

GpioOrders GpioInputs::poll(hal::Stamp now) noexcept {
  GpioOrders orders;
  orders.scan_wanted = was_triggered(now);
  orders.interlock_open = is_open(now);
  counters_.count(GpioInputEvent::InterlockOpenings, orders.interlock_open && !was_open_ ? 1 : 0);
  was_open_ = orders.interlock_open;
  return orders;
}

bool GpioInputs::was_triggered(hal::Stamp now) noexcept {
  bool was = false;
  for (int i = 0; lines_.trigger != nullptr && i < kEdgesMax; ++i) {
    const std::optional<hal::GpioEvent> event = lines_.trigger->next_event(now);
    if (!event) {
      break;
    }
    if (event->edge == hal::GpioEdge::ToActive) {
      counters_.count(GpioInputEvent::TriggerEdges);
      was = true;
    }
  }
  return was;
}

bool GpioInputs::is_open(hal::Stamp now) noexcept {
  if (lines_.interlock == nullptr) {
    return false;
  }
  bool opened = false;
  for (int i = 0; i < kEdgesMax; ++i) {
    const std::optional<hal::GpioEvent> event = lines_.interlock->next_event(now);
    if (!event) {
      break;
    }
    opened = opened || event->edge == hal::GpioEdge::ToInactive;
  }
  const std::optional<hal::GpioLevel> level = lines_.interlock->level(now);
  counters_.count(GpioInputEvent::InterlockLost, level ? 0 : 1);
  return opened || level != hal::GpioLevel::Active;
}

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

/// Sets a line only when its level changes.
void GpioOutputs::set(hal::GpioOutput* line, hal::GpioLevel level, GpioOutputEvent failure) noexcept {
  if (line != nullptr && line->level() != level && line->set(level) == hal::GpioStatus::Failed) {
    counters_.count(failure);
  }
}

tl::expected<std::unique_ptr<GpioPanel>, hal::InitError> GpioPanel::open(const GpioConfig& config,
                                                                         const GpioOpeners& openers) {
  auto trigger = open_input(config.trigger, hal::GpioEdges::ToActive, "gpio.trigger", openers);
  if (!trigger) {
    return tl::unexpected(trigger.error());
  }
  // Both edges are asked for, so that an opening between two polls is seen.
  auto interlock = open_input(config.interlock, hal::GpioEdges::Both, "gpio.interlock", openers);
  if (!interlock) {
    return tl::unexpected(interlock.error());
  }
  auto led = open_output(config.led, "gpio.led", openers);
  if (!led) {
    return tl::unexpected(led.error());
  }
  auto pulse = open_output(config.pulse, "gpio.pulse", openers);
  if (!pulse) {
    return tl::unexpected(pulse.error());
  }
  return std::unique_ptr<GpioPanel>(new GpioPanel({std::move(*trigger), std::move(*interlock)},
                                                  {std::move(*led), std::move(*pulse)},
                                                  hal::from_seconds(config.pulse_s)));
}

GpioPanel::GpioPanel(GpioInputLines inputs, GpioOutputLines outputs, hal::Stamp pulse) noexcept
    : inputs_(std::move(inputs)), outputs_(std::move(outputs), pulse) {
}

}  // namespace slamsensor::firmware
