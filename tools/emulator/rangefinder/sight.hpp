#pragma once

#include "tools/emulator/emulated_device.hpp"

#include <array>
#include <cstdint>

namespace slamsensor::tools {

/// The faults that last for a while or wait for the next record.
class FaultWindows {
 public:
  FaultWindows() { until_.fill(Stamp::min()); }

  /// `fault` lasts from now to the end of its duration.
  void open(const Fault& fault) { until_[index(fault.kind)] = fault.at + fault.duration; }

  [[nodiscard]] bool is_open(FaultKind kind, Stamp now) const { return now < until_[index(kind)]; }

  /// The next record shall have this fault.
  void order(FaultKind kind) { ++ordered_[index(kind)]; }

  /// Whether a record now has the fault; an order is used up by it.
  [[nodiscard]] bool take(FaultKind kind);

 private:
  [[nodiscard]] static std::size_t index(FaultKind kind) { return static_cast<std::size_t>(kind); }

  std::array<Stamp, kFaultKinds> until_{};
  std::array<std::uint32_t, kFaultKinds> ordered_{};
};

/// What came back of a shot.
enum class SightKind : std::uint8_t { Nothing, Target, Weak, Saturated, Error };

struct Sight {
  SightKind kind = SightKind::Nothing;
  double range_m = 0.0;      ///< of Target, Weak and Saturated: where the thing is
  double reflectance = 0.0;  ///< of the same

  [[nodiscard]] bool has_echo() const { return kind != SightKind::Nothing && kind != SightKind::Error; }
};

/// One shot at `at`, as the faults of that moment make it look.
[[nodiscard]] Sight look(RangeScene& scene, Stamp at, const FaultWindows& faults);

/// Echo strength by the law of diffuse reflection: falls with the square of the range, up to a ceiling.
struct StrengthModel {
  double at_1m = 0.0;    ///< of a white target one metre away, were there no ceiling
  double ceiling = 0.0;  ///< most that the device tells

  [[nodiscard]] double of(const Sight& sight) const;
};

}  // namespace slamsensor::tools
