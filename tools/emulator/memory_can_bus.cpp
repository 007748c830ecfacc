#include "tools/emulator/memory_can_bus.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

// Checksum delimiter, acknowledge slot and delimiter, end of frame (7), intermission (3): never stuffed.
constexpr std::size_t kTailBits = 13;
constexpr std::uint32_t kBaseMask = 0x7FF;
constexpr std::uint32_t kExtensionBits = 18;
constexpr std::uint32_t kExtensionMask = 0x3FFFF;

/// Counts the bits that are put on the bus, and keeps the CRC-15 (polynomial 0x4599) of those before
/// stuffing.
class BitCounter {
 public:
  void put(std::uint32_t value, unsigned bits) {
    while (bits-- > 0) {
      put_bit((value >> bits) & 1U);
    }
  }
  void put_checksum() { put(crc_, 15); }
  [[nodiscard]] std::size_t bits() const { return bits_; }

 private:
  void put_bit(std::uint32_t bit) {
    const std::uint32_t feedback = bit ^ (crc_ >> 14U);
    crc_ = ((crc_ << 1U) & 0x7FFFU) ^ (feedback != 0 ? 0x4599U : 0U);
    equal_ = bit == last_ ? equal_ + 1 : 1;
    last_ = bit;
    ++bits_;
    if (equal_ == 5) {
      ++bits_;
      last_ ^= 1U;
      equal_ = 1;
    }
  }

  std::uint32_t crc_ = 0;
  std::uint32_t last_ = 2;  // neither
  unsigned equal_ = 0;
  std::size_t bits_ = 0;
};

}  // namespace

std::size_t can_frame_bits(const hal::CanFrame& frame) {
  BitCounter counter;
  counter.put(0, 1);  // start of frame
  if (frame.extended) {
    counter.put(frame.id >> kExtensionBits, 11);
    counter.put(3, 2);  // substitute remote request, identifier extension
    counter.put(frame.id, kExtensionBits);
    counter.put(0, 3);  // remote request, two reserved
  } else {
    counter.put(frame.id, 11);
    counter.put(0, 3);  // remote request, identifier extension, reserved
  }
  counter.put(static_cast<std::uint32_t>(frame.bytes().size()), 4);
  for (const std::uint8_t byte : frame.bytes()) {
    counter.put(byte, 8);
  }
  counter.put_checksum();
  return counter.bits() + kTailBits;
}

hal::Stamp can_frame_time(const hal::CanFrame& frame, std::uint32_t bitrate) {
  return hal::Stamp(static_cast<hal::Stamp::rep>(can_frame_bits(frame)) * 1'000'000'000 /
                    static_cast<hal::Stamp::rep>(bitrate));
}

std::uint32_t arbitration_key(const hal::CanFrame& frame) noexcept {
  const std::uint32_t base = frame.extended ? frame.id >> kExtensionBits : frame.id;
  const std::uint32_t tail = frame.extended ? (1U << kExtensionBits) | (frame.id & kExtensionMask) : 0;
  return ((base & kBaseMask) << (kExtensionBits + 1)) | tail;
}

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

namespace {

using hal::CanRead;
using hal::LinkStatus;

bool is_sendable(const hal::CanFrame& frame) noexcept {
  const std::uint32_t id_max = frame.extended ? 0x1FFF'FFFF : 0x7FF;
  return frame.id <= id_max && frame.size <= frame.data.size();
}

}  // namespace

MemoryCanLink::MemoryCanLink(MemoryCanBus& bus, const SimClock& clock, const hal::ReopenConfig& reopen)
    : bus_(bus), clock_(clock), host_(bus.add_host()), timer_(reopen) {
}

bool MemoryCanLink::is_lost() noexcept {
  if (up_ && (!bus_.is_host_up() || bus_.up_count() != up_count_)) {
    up_ = false;
    timer_.lost(clock_.now);
  }
  return !up_;
}

void MemoryCanLink::service(hal::Stamp now) noexcept {
  if (!is_lost() || !timer_.is_due(now)) {
    return;
  }
  if (!bus_.is_host_up()) {
    timer_.failed(now);
    return;
  }
  up_ = true;
  ++epoch_;
  up_count_ = bus_.up_count();
  timer_.opened(now);
  bus_.host_discard(host_);
}

CanRead MemoryCanLink::receive() noexcept {
  if (is_lost()) {
    return {LinkStatus::Down, {}, {}};
  }
  const auto arrival = bus_.host_take(host_);
  return arrival ? CanRead{LinkStatus::Ok, arrival->frame, arrival->at} : CanRead{};
}

LinkStatus MemoryCanLink::send(const hal::CanFrame& frame) noexcept {
  if (is_lost() || !is_sendable(frame)) {
    return LinkStatus::Down;
  }
  return bus_.host_send(host_, frame, clock_.now) ? LinkStatus::Ok : LinkStatus::Busy;
}

}  // namespace slamsensor::tools
