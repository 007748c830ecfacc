#pragma once

#include "hal/pantilt/canopen/canopen_drive.hpp"

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

  /// Absent is told as Starting.
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

}  // namespace slamsensor::hal
