#include "tools/emulator/emulated_port.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kArrivedMax = 65'536;
constexpr std::uint64_t kToHostStream = 0;
constexpr std::uint64_t kToDeviceStream = 1;

}  // namespace

EmulatedPort::EmulatedPort(std::uint64_t seed)
    : to_host_(mix_seed(seed, kToHostStream)), to_device_(mix_seed(seed, kToDeviceStream)) {
}

void EmulatedPort::host_write(std::span<const std::uint8_t> bytes, Stamp now) {
  if (plugged_) {
    to_device_.send(bytes, now, host_baud_);
  }
}

std::size_t EmulatedPort::host_take(std::span<WireByte> into, Stamp until) {
  std::size_t count = 0;
  while (count < into.size() && !arrived_.empty() && arrived_.front().at <= until) {
    into[count++] = arrived_.front();
    arrived_.pop_front();
  }
  return count;
}

Stamp EmulatedPort::next_event() const {
  if (device_ == nullptr) {
    return plug_at_;
  }
  return std::min({plug_at_, device_->next_event(), to_device_.next_arrival(device_->baud())});
}

Stamp EmulatedPort::next_delivery() const {
  return to_host_.next_arrival(host_baud_);
}

void EmulatedPort::advance(Stamp now) {
  run_events(*this, guard_, now, [this](Stamp event) { step(event); });
  if (device_ != nullptr) {
    device_->advance(now);
  }
  deliver(now);
}

void EmulatedPort::step(Stamp event) {
  if (plug_at_ <= event) {
    plug_in();
  }
  if (device_ == nullptr) {
    return;
  }
  device_->advance(event);
  // One at a time: what the device makes of a byte may change its rate.
  if (const auto byte = to_device_.next(event, device_->baud())) {
    device_->receive(byte->value, event);
  }
}

void EmulatedPort::deliver(Stamp now) {
  while (const auto byte = to_host_.next(now, host_baud_)) {
    if (arrived_.size() < kArrivedMax) {
      arrived_.push_back(*byte);
    } else {
      ++overruns_;
    }
  }
}

void EmulatedPort::send(std::span<const std::uint8_t> bytes, Stamp at) {
  if (plugged_ && device_ != nullptr) {
    to_host_.send(bytes, at, device_->baud());
  }
}

bool EmulatedPort::inject(const Fault& fault) {
  deliver(fault.at);
  if (fault.kind == FaultKind::CableOut) {
    pull_cable(fault);
    return true;
  }
  return to_host_.inject(fault) || (device_ != nullptr && device_->inject(fault));
}

void EmulatedPort::plug_in() {
  if (!plugged_) {
    plug_at_ = hal::kNever;
    plugged_ = true;
    ++plug_count_;
  }
}

void EmulatedPort::pull_cable(const Fault& fault) {
  const Stamp until = fault.at + fault.duration;
  plug_at_ = plugged_ ? until : std::max(plug_at_, until);
  plugged_ = false;
  to_host_.clear();
  to_device_.clear();
  arrived_.clear();
}

}  // namespace slamsensor::tools
