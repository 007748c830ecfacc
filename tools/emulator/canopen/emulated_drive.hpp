#pragma once

#include "tools/emulator/canopen/drive_axis.hpp"
#include "tools/emulator/canopen/drive_control.hpp"
#include "tools/emulator/canopen/emulated_node.hpp"
#include "tools/emulator/emulated_device.hpp"

#include <array>
#include <deque>
#include <vector>

namespace slamsensor::tools {

/// CiA 301, states of a node as its heartbeat reports them.
enum class NodeState : std::uint8_t {
  Boot = 0x00,
  Stopped = 0x04,
  Operational = 0x05,
  PreOperational = 0x7F
};

/// A node of a CANopen bus that is a CiA 402 drive with one axis: boot-up, NMT, heartbeat, SDO, PDOs on SYNC
/// and by event, emergencies.
class EmulatedDrive final : public EmulatedCanDevice, private ObjectKeeper {
 public:
  /// Begins at time 0 as its settings say. `sink` outlives it.
  EmulatedDrive(const DriveSettings& settings, FrameSink& sink, std::uint64_t seed);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override;
  void receive(const hal::CanFrame& frame, Stamp at) override;

  /// Knows PowerCycle, Silence, Emergency (no fault reset while it lasts), SdoAbort, SdoSilence, NodeReset,
  /// HeartbeatLost and MissedSteps (something holds the axis: following error).
  bool inject(const Fault& fault) override;

  /// Where the axis truly is, in rad.
  [[nodiscard]] double angle_rad(Stamp at) const { return axis_.truth(at) / settings_.counts_per_rad(); }
  [[nodiscard]] bool is_moving(Stamp at) const { return axis_.is_moving(at); }

  [[nodiscard]] NodeState node_state() const noexcept { return node_state_; }
  [[nodiscard]] PowerState drive_state() const noexcept { return control_.state(); }

  /// Frames that made no sense to it: PDOs too short, SDO requests that are not 8 bytes.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  struct Outgoing {
    Stamp due{};
    hal::CanFrame frame;
  };
  struct Transmit {
    std::uint8_t syncs = 0;       // since the last one on SYNC
    std::int64_t sent_word = -1;  // the status word in the last one
    Stamp may_at = Stamp::min();  // the inhibit time is over
    Stamp timer_at = hal::kNever;
  };

  SdoAbort read_object(ObjectKey key, std::vector<std::uint8_t>& bytes) override;
  SdoAbort write_object(ObjectKey key, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::size_t object_width(ObjectKey key) const override { return objects_.width(key); }
  [[nodiscard]] SdoAbort check_meaning(ObjectKey key, std::int64_t value) const;
  void apply(ObjectKey key, std::int64_t value, Stamp now);
  [[nodiscard]] std::int64_t live_value(ObjectKey key, Stamp at) const;
  void remember_error(const DriveError& error);

  void boot(Stamp now);
  void reset(Stamp now);
  void reset_communication(Stamp now);
  void enter(NodeState state, Stamp now);
  void obey_nmt(const hal::CanFrame& frame, Stamp now);
  void serve(const hal::CanFrame& frame, Stamp now);
  void take_sync(Stamp now);
  [[nodiscard]] bool take_pdo(const hal::CanFrame& frame, Stamp now);
  void apply_pdo(const DrivePdo& pdo, std::span<const std::uint8_t> bytes, Stamp now);

  [[nodiscard]] DrivePdo transmit_pdo(std::size_t n) const;
  [[nodiscard]] DrivePdo receive_pdo(std::size_t n) const;
  [[nodiscard]] bool tells_change(std::size_t n, Stamp at) const;
  [[nodiscard]] Stamp next_transmit(std::size_t n) const;
  void arm_timer(std::size_t n, Stamp now);
  void transmit(std::size_t n, Stamp latch, Stamp now);
  void publish(Stamp now);
  void step(Stamp now);
  void settle(Stamp now);

  void tell_error(const DriveError& error, Stamp now);
  void put(std::uint32_t id, std::span<const std::uint8_t> bytes, Stamp due);
  void release(Stamp now);

  const DriveSettings settings_;
  FrameSink& sink_;
  const ObjectDictionary defaults_;
  ObjectDictionary objects_;
  DriveAxis axis_;
  DriveControl control_;
  SdoServer sdo_;
  PowerSwitch power_;
  DelayDraw sdo_latency_;
  DelayDraw pdo_latency_;
  NodeState node_state_ = NodeState::Boot;
  Stamp now_{};  // of the frame or event that is dealt with

  std::deque<Outgoing> outbox_;  // in the order of `due`
  Stamp last_reply_ = Stamp::min();
  Stamp last_pdo_ = Stamp::min();
  Stamp heartbeat_at_ = hal::kNever;
  std::array<Transmit, kDrivePdos> transmits_;
  std::array<std::vector<std::uint8_t>, kDrivePdos> held_;  // PDOs received that wait for SYNC
  std::deque<std::uint16_t> errors_;                        // newest first

  Stamp silent_until_ = Stamp::min();
  Stamp no_heartbeat_until_ = Stamp::min();
  std::uint64_t refused_ = 0;
};

/// A pan-tilt unit of two CiA 402 axes, each a node of its own on the bus.
class EmulatedCanopenHead final : public EmulatedDevice, public PointingTruth {
 public:
  /// The sinks outlive it. Its drives are to be attached to the bus at the nodes of their sinks.
  EmulatedCanopenHead(const CanopenHeadSettings& settings, FrameSink& pan, FrameSink& tilt,
                      std::uint64_t seed);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override;

  /// As EmulatedDrive::inject(): PowerCycle and Silence befall both axes, else a moving one, else either.
  bool inject(const Fault& fault) override;

  [[nodiscard]] HeadAngles angles_at(Stamp at) const override;

  [[nodiscard]] EmulatedDrive& pan() noexcept { return pan_; }
  [[nodiscard]] EmulatedDrive& tilt() noexcept { return tilt_; }

 private:
  EmulatedDrive pan_;
  EmulatedDrive tilt_;
  Random rng_;
};

}  // namespace slamsensor::tools
