#include "tools/emulator/memory_can_bus.hpp"

#include "tools/emulator/can_frame_time.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kWaitingMax = 4096;
constexpr std::size_t kArrivedMax = 4096;

}  // namespace

void MemoryCanBus::Node::send(const hal::CanFrame& frame, Stamp at) {
  if (waiting.size() >= kWaitingMax) {
    ++bus.overruns_;
    return;
  }
  waiting.push_back({frame, waiting.empty() ? at : std::max(at, waiting.back().at)});
}

FrameSink& MemoryCanBus::add_device_node() {
  return *nodes_.emplace_back(std::make_unique<Node>(*this));
}

void MemoryCanBus::attach(FrameSink& node, EmulatedCanDevice& device) {
  for (const auto& known : nodes_) {
    if (known.get() == &node) {
      known->device = &device;
    }
  }
}

std::size_t MemoryCanBus::add_host() {
  hosts_.push_back(nodes_.emplace_back(std::make_unique<Node>(*this)).get());
  return hosts_.size() - 1;
}

bool MemoryCanBus::host_send(std::size_t host, const hal::CanFrame& frame, Stamp now) {
  Node& node = *hosts_.at(host);
  if (!host_up_ || node.waiting.size() >= kHostQueue) {
    return false;
  }
  node.send(frame, now);
  return true;
}

std::optional<MemoryCanBus::Arrival> MemoryCanBus::host_take(std::size_t host) {
  std::deque<Arrival>& arrived = hosts_.at(host)->arrived;
  if (arrived.empty()) {
    return std::nullopt;
  }
  const Arrival oldest = arrived.front();
  arrived.pop_front();
  return oldest;
}

void MemoryCanBus::host_discard(std::size_t host) {
  hosts_.at(host)->arrived.clear();
}

Stamp MemoryCanBus::next_start() const {
  Stamp next = hal::kNever;
  for (const auto& node : nodes_) {
    if (!node->waiting.empty()) {
      next = std::min(next, std::max(node->waiting.front().at, free_at_));
    }
  }
  return next;
}

Stamp MemoryCanBus::next_event() const {
  Stamp next = std::min(host_up_at_, on_bus_ ? free_at_ : next_start());
  for (const auto& node : nodes_) {
    next = node->device != nullptr ? std::min(next, node->device->next_event()) : next;
  }
  return next;
}

Stamp MemoryCanBus::next_delivery() const {
  return on_bus_ ? free_at_ : next_start();
}

void MemoryCanBus::advance(Stamp now) {
  run_events(*this, guard_, now, [this](Stamp event) { step(event); });
  for (const auto& node : nodes_) {
    if (node->device != nullptr) {
      node->device->advance(now);
    }
  }
}

void MemoryCanBus::step(Stamp event) {
  if (host_up_at_ <= event) {
    come_up();
  }
  for (const auto& node : nodes_) {
    if (node->device != nullptr) {
      node->device->advance(event);
    }
  }
  if (on_bus_ && free_at_ <= event) {
    finish_frame(event);
  }
  if (!on_bus_ && next_start() <= event) {
    start_frame(event);
  }
}

void MemoryCanBus::start_frame(Stamp at) {
  sender_ = nullptr;
  for (const auto& node : nodes_) {
    const bool ready = !node->waiting.empty() && node->waiting.front().at <= at;
    if (ready && (sender_ == nullptr || arbitration_key(node->waiting.front().frame) <
                                            arbitration_key(sender_->waiting.front().frame))) {
      sender_ = node.get();
    }
  }
  on_bus_ = sender_->waiting.front().frame;
  sender_->waiting.pop_front();
  free_at_ = at + can_frame_time(*on_bus_, bitrate_);
}

void MemoryCanBus::finish_frame(Stamp at) {
  const hal::CanFrame frame = *on_bus_;
  on_bus_.reset();
  const bool from_device = sender_->device != nullptr;
  const bool lost = from_device && host_up_ && lost_frames_ > 0;
  lost_frames_ -= lost ? 1 : 0;
  for (const auto& node : nodes_) {
    const bool is_deaf = node->device == nullptr && (!host_up_ || lost);
    if (node.get() != sender_ && !is_deaf) {
      receive_at(*node, frame, at);
    }
  }
}

void MemoryCanBus::receive_at(Node& node, const hal::CanFrame& frame, Stamp at) {
  if (node.device != nullptr) {
    node.device->receive(frame, at);
  } else if (node.arrived.size() < kArrivedMax) {
    node.arrived.push_back({frame, at});
  } else {
    ++overruns_;
  }
}

void MemoryCanBus::come_up() {
  if (!host_up_) {
    host_up_at_ = hal::kNever;
    host_up_ = true;
    ++up_count_;
  }
}

void MemoryCanBus::take_down(Stamp until) {
  host_up_at_ = host_up_ ? until : std::max(host_up_at_, until);
  host_up_ = false;
  for (Node* const host : hosts_) {
    host->waiting.clear();
    host->arrived.clear();
    if (on_bus_ && sender_ == host) {
      on_bus_.reset();
    }
  }
}

bool MemoryCanBus::inject(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::InterfaceDown:
    case FaultKind::BusOff:
      take_down(fault.at + fault.duration);
      return true;
    case FaultKind::LostFrame:
      ++lost_frames_;
      return true;
    default:
      return false;
  }
}

}  // namespace slamsensor::tools
