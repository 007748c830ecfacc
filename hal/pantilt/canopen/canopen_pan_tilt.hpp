#pragma once

#include "hal/init_error.hpp"
#include "hal/pantilt/canopen/canopen_drive.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>

namespace slamsensor::hal {

/// One node of the unit: starts it up, watches it, and starts it over with back-off after a loss.
class CanopenNode {
 public:
  /// All of them outlive this.
  CanopenNode(Axis axis, const CanopenConfig& config, CanLink& link, CanopenCounters& counters,
              CanopenSamples& samples) noexcept;

  /// The bus is up (again): the node is looked for anew.
  void begin(Stamp now) noexcept;

  /// The bus is down.
  void lose_link() noexcept;

  void step(Stamp now) noexcept;

  /// Takes a frame if it is this node's.
  void on_frame(const CanRead& got, Stamp now) noexcept;
  void on_sync(Stamp sent) noexcept { drive_.on_sync(sent); }

  /// Absent is reported as Starting.
  [[nodiscard]] DeviceState state() const noexcept { return state_; }
  [[nodiscard]] CanopenProblem problem() const noexcept { return problem_; }
  [[nodiscard]] bool wants_sync() const noexcept;
  [[nodiscard]] const CanopenFacts& facts() const noexcept { return startup_.facts(); }
  [[nodiscard]] CanopenDrive& drive() noexcept { return drive_; }
  [[nodiscard]] const CanopenDrive& drive() const noexcept { return drive_; }

 private:
  void fail(CanopenProblem problem, Stamp now) noexcept;
  void on_heartbeat(const CanRead& got, Stamp now) noexcept;
  void on_emergency(const CanRead& got, Stamp now) noexcept;
  [[nodiscard]] CanopenProblem watch(Stamp now) noexcept;

  const CanopenConfig& config_;
  const CanopenAxisConfig& axis_;
  CanopenCounters& counters_;
  SdoClient sdo_;
  CanopenStartup startup_;
  CanopenDrive drive_;
  DeviceState state_ = DeviceState::Starting;
  CanopenProblem problem_ = CanopenProblem::NotTried;
  bool waiting_ = false;  // for the next attempt
  Stamp retry_at_{};
  Stamp retry_wait_{};
  Stamp heard_{};  // heartbeat
};

/// Driver of a pan-tilt unit of two CANopen drives (CiA 301, CiA 402) on one bus, of which it is the master:
/// it starts the nodes, sends SYNC and watches their heartbeats.
///
/// A position that is latched at SYNC has the time at which the SYNC was sent; one sent on an event the time
/// of its arrival; one asked for the middle of the gap between request and reply.
class CanopenPanTilt final : public PanTilt {
 public:
  /// A driver that starts up at its first step(). Refuses a configuration out of the bounds given in
  /// CanopenConfig. `link` outlives the driver.
  [[nodiscard]] static tl::expected<std::unique_ptr<CanopenPanTilt>, InitError> create(
      const CanopenConfig& config, CanLink& link);

  void step(Stamp now) noexcept override;
  [[nodiscard]] DeviceState state() const noexcept override { return state_; }
  [[nodiscard]] std::string_view problem() const noexcept override;
  [[nodiscard]] std::span<const Counter> counters() const noexcept override { return counters_.all(); }

  [[nodiscard]] MoveStatus move(Axis axis, double target_rad, double speed_radps) noexcept override;
  [[nodiscard]] MoveStatus halt() noexcept override;
  [[nodiscard]] const AxisStatus& axis(Axis axis) const noexcept override;
  [[nodiscard]] const PanTiltInfo& info() const noexcept override { return info_; }
  [[nodiscard]] std::size_t take(std::span<AxisSample> into) noexcept override { return samples_.take(into); }

 private:
  CanopenPanTilt(const CanopenConfig& config, CanLink& link) noexcept;

  [[nodiscard]] bool link_ready(Stamp now) noexcept;
  void receive(Stamp now) noexcept;
  void send_sync(Stamp now) noexcept;
  void update_state() noexcept;

  const CanopenConfig config_;
  CanLink& link_;
  CanopenCounters counters_{kCanopenEventNames};
  CanopenSamples samples_;
  CanopenNode pan_;
  CanopenNode tilt_;
  PanTiltInfo info_;
  DeviceState state_ = DeviceState::Absent;
  std::uint32_t epoch_ = 0;
  Stamp next_sync_ = Stamp::min();
};

}  // namespace slamsensor::hal
