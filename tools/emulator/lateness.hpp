#pragma once

#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace slamsensor::tools {

/// How much later than it was due each byte (or frame) was given to the host.
class Lateness {
 public:
  void count(hal::Stamp late, std::uint64_t times = 1) noexcept;

  [[nodiscard]] hal::Stamp worst() const noexcept { return worst_; }
  [[nodiscard]] std::uint64_t total() const noexcept { return total_; }

  /// The least bound that at least `share` (0 to 1) of all stayed within; kNever when it lies beyond the last
  /// bound, 0 when there were none.
  [[nodiscard]] hal::Stamp within(double share) const noexcept;

  /// "worst 0.41 ms; up to 0.1 ms: 1234, 0.2 ms: 56, ..." without the empty ones; "nothing was sent".
  [[nodiscard]] std::string text() const;

  static constexpr std::array<double, 10> kBounds_ms = {0.1, 0.2,  0.5,  1.0,  2.0,
                                                        5.0, 10.0, 20.0, 50.0, 100.0};

 private:
  std::array<std::uint64_t, kBounds_ms.size() + 1> counts_{};
  std::uint64_t total_ = 0;
  hal::Stamp worst_{};
};

}  // namespace slamsensor::tools
