#include "firmware/gpio/gpio_inputs.hpp"

#include <optional>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr int kEdgesMax = 16;  // taken in one poll: what the kernel keeps

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

}  // namespace slamsensor::firmware
