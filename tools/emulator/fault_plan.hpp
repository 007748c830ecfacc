#pragma once

#include "hal/stamp.hpp"
#include "tools/emulator/fault.hpp"
#include "tools/world/random.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// A fault at a given time, counted from the start of the scenario, in the device (or bus) of that name.
struct PlannedFault {
  std::string device;
  FaultKind kind = FaultKind::DropByte;
  double at_s = 0.0;
  double duration_s = 0.0;
};

/// When the faults of a rate come.
enum class FaultRhythm : std::uint8_t {
  Chance,   ///< a Poisson process: independent of each other
  Regular,  ///< every `mean_gap_s` exactly
};

/// Faults of one kind that come again and again from `from_s` until `until_s`.
struct FaultRate {
  std::string device;
  FaultKind kind = FaultKind::DropByte;
  FaultRhythm rhythm = FaultRhythm::Chance;
  double mean_gap_s = 60.0;
  double from_s = 0.0;
  double until_s = 1e9;
  double duration_s = 0.0;
};

/// A fault that is due.
struct DueFault {
  std::string device;
  Fault fault;
};

/// The faults of a scenario as one stream in the order of time. Each rate has its own random stream. Equal
/// arguments, equal faults.
class FaultPlan {
 public:
  FaultPlan() = default;
  FaultPlan(std::span<const PlannedFault> planned, std::span<const FaultRate> rates, std::uint64_t seed);

  /// When the next fault is due; hal::kNever when there are no more.
  [[nodiscard]] hal::Stamp next() const noexcept;

  /// The next fault when it is due at `now`, taken out of the stream.
  [[nodiscard]] std::optional<DueFault> take(hal::Stamp now);

 private:
  struct Source {
    FaultRate rate;
    Random rng;
    double next_s;

    void draw_next();
  };

  [[nodiscard]] const Source* earliest_source() const noexcept;

  std::vector<PlannedFault> planned_;  // the last is the next
  std::vector<Source> sources_;
};

}  // namespace slamsensor::tools
