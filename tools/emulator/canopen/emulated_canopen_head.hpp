#pragma once

#include "tools/emulator/canopen/emulated_drive.hpp"

namespace slamsensor::tools {

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
