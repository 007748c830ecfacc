#pragma once

#include "tools/emulator/canopen/emulated_node.hpp"
#include "tools/emulator/emulated_device.hpp"

#include <cstdint>
#include <vector>

namespace slamsensor::tools {

struct InclinometerSettings {
  std::uint8_t node_id = 10;
  std::uint16_t resolution = 10;  ///< object 6000h: 1, 10, 100 or 1000 thousandths of a degree
  bool has_32_bits = false;       ///< objects 6110h and 6120h beside those of 16 bits
  double range_rad = 1.0;         ///< an axis that leans by more reports 200 deg, and an emergency says so
  Stamp period = std::chrono::milliseconds(100);  ///< of TPDO 1 while operational
  DeviceBegin begin = DeviceBegin::Ready;
  Stamp boot_time = std::chrono::milliseconds(300);
};

/// A node of a CANopen bus that is an inclinometer of two axes (CiA 410): boot-up, NMT, SDO, TPDO 1 by its
/// timer, emergencies. Its x axis points forward and its y axis to the left; a slope is positive when the end
/// of its axis is below (x) or above (y) the horizontal.
class EmulatedInclinometer final : public EmulatedCanDevice, private ObjectKeeper {
 public:
  /// `sink` outlives it.
  EmulatedInclinometer(const InclinometerSettings& settings, FrameSink& sink);

  /// It stands so from `at` on: roll about x, then pitch about y (REP 103).
  void lean(double roll_rad, double pitch_rad, Stamp at);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override;
  void receive(const hal::CanFrame& frame, Stamp at) override;

  /// Knows PowerCycle, NodeReset, Silence, SdoAbort, SdoSilence and Emergency.
  bool inject(const Fault& fault) override;

 private:
  SdoAbort read_object(ObjectKey key, std::vector<std::uint8_t>& bytes) override;
  SdoAbort write_object(ObjectKey key, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::size_t object_width(ObjectKey key) const override { return objects_.width(key); }

  void boot(Stamp now);
  void measure();
  void obey_nmt(const hal::CanFrame& frame, Stamp now);
  void tell_emergency(std::uint16_t code, std::uint8_t error_register, Stamp now);
  void send(std::uint32_t id, std::span<const std::uint8_t> bytes, Stamp at);

  const InclinometerSettings settings_;
  FrameSink& sink_;
  ObjectDictionary objects_;
  SdoServer sdo_;
  PowerSwitch power_;
  double x_rad_ = 0.0;  // slopes
  double y_rad_ = 0.0;
  bool is_operational_ = false;
  bool is_over_range_ = false;
  Stamp pdo_at_ = hal::kNever;
  Stamp silent_until_ = Stamp::min();
};

}  // namespace slamsensor::tools
