#pragma once

#include "hal/transport/can_link.hpp"
#include "hal/transport/reopen.hpp"
#include "tools/emulator/emulated_device.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace slamsensor::tools {

/// Bits that a classical data frame takes on the bus, stuff bits and the intermission of 3 bits included
/// (ISO 11898-1: a bit of opposite level after five equal ones, from start of frame to the checksum's end).
[[nodiscard]] std::size_t can_frame_bits(const hal::CanFrame& frame);

/// The same as a length of time at `bitrate` bit/s (positive), rounded down to the nanosecond.
[[nodiscard]] hal::Stamp can_frame_time(const hal::CanFrame& frame, std::uint32_t bitrate);

/// What decides which of two frames goes first when both want the bus: the smaller one. A base frame goes
/// before an extended one with the same first 11 bits.
[[nodiscard]] std::uint32_t arbitration_key(const hal::CanFrame& frame) noexcept;

/// A CAN bus in memory: frames take their bits' time, one at a time; when several nodes want the bus, the
/// lowest identifier goes first. A node's own frames keep their order. Every node sees the frames of all
/// others. Hosts are nodes whose interface can be down or bus-off.
class MemoryCanBus final : public EmulatedLine {
 public:
  struct Arrival {
    hal::CanFrame frame;
    Stamp at{};
  };

  explicit MemoryCanBus(std::uint32_t bitrate = 1'000'000) : bitrate_(bitrate) {}

  /// A new node for a device, to be given to it at its construction; attach() the device before the first
  /// event. The sink lives as long as the bus.
  [[nodiscard]] FrameSink& add_device_node();
  void attach(FrameSink& node, EmulatedCanDevice& device);

  /// A new host; the number to name it by below.
  [[nodiscard]] std::size_t add_host();

  /// False while the hosts' interfaces are down or bus-off.
  [[nodiscard]] bool is_host_up() const noexcept { return host_up_; }

  /// Grows by one each time the hosts' interfaces come up; 1 at the beginning.
  [[nodiscard]] std::uint32_t up_count() const noexcept { return up_count_; }

  /// Ends an InterfaceDown or BusOff at once; nothing when the interfaces are up.
  void come_up();

  /// False when the interface is down or `host` has `kHostQueue` frames waiting for the bus.
  [[nodiscard]] bool host_send(std::size_t host, const hal::CanFrame& frame, Stamp now);

  /// The oldest frame that has arrived at `host`.
  [[nodiscard]] std::optional<Arrival> host_take(std::size_t host);
  void host_discard(std::size_t host);

  /// Frames that a host lost because it did not take them, or a device because 4096 of it waited already.
  [[nodiscard]] std::uint64_t overruns() const noexcept { return overruns_; }

  [[nodiscard]] Stamp next_event() const override;
  [[nodiscard]] Stamp next_delivery() const override;
  void advance(Stamp now) override;

  /// InterfaceDown, BusOff and LostFrame; faults of a device are injected into the device.
  bool inject(const Fault& fault) override;

  static constexpr std::size_t kHostQueue = 64;

 private:
  struct Node final : FrameSink {
    explicit Node(MemoryCanBus& owner) : bus(owner) {}
    void send(const hal::CanFrame& frame, Stamp at) override;

    MemoryCanBus& bus;
    EmulatedCanDevice* device = nullptr;  // null for a host
    std::deque<Arrival> waiting;          // to be sent, `at` is "not before"
    std::deque<Arrival> arrived;          // at a host
  };

  [[nodiscard]] Stamp next_start() const;
  void step(Stamp event);
  void start_frame(Stamp at);
  void finish_frame(Stamp at);
  void receive_at(Node& node, const hal::CanFrame& frame, Stamp at);
  void take_down(Stamp until);

  std::uint32_t bitrate_;
  std::vector<std::unique_ptr<Node>> nodes_;
  std::vector<Node*> hosts_;
  std::optional<hal::CanFrame> on_bus_;
  Node* sender_ = nullptr;  // of the frame on the bus
  Stamp free_at_{};         // end of the frame on the bus, or of the last one
  bool host_up_ = true;
  std::uint32_t up_count_ = 1;
  Stamp host_up_at_ = hal::kNever;
  std::uint32_t lost_frames_ = 0;  // still to be lost
  std::uint64_t overruns_ = 0;
  EventGuard guard_;
};

/// A host on a MemoryCanBus in simulated time, with the manners of a CAN socket: opened by service(), lost
/// with the interface or the bus, opened again with back-off. The bus was advanced to the clock's time before
/// each call. It hands out every frame.
class MemoryCanLink final : public hal::CanLink {
 public:
  /// Both outlive the link.
  MemoryCanLink(MemoryCanBus& bus, const SimClock& clock, const hal::ReopenConfig& reopen = {});

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return epoch_; }
  [[nodiscard]] bool is_up() const noexcept override { return up_; }
  [[nodiscard]] hal::CanRead receive() noexcept override;

  /// Down also for a frame that no CAN bus takes: an identifier or a size beyond its bits.
  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override;

 private:
  bool is_lost() noexcept;

  MemoryCanBus& bus_;
  const SimClock& clock_;
  std::size_t host_;
  hal::ReopenTimer timer_;
  std::uint32_t epoch_ = 0;
  std::uint32_t up_count_ = 0;  // of the bus when it was opened
  bool up_ = false;
};

}  // namespace slamsensor::tools
