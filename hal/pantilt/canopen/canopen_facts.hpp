#pragma once

#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/canopen/canopen_script.hpp"
#include "hal/pantilt/pan_tilt.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::hal {

/// What a drive said of itself, in the units of this program.
struct CanopenFacts {
  AxisInfo info;
  double rad_per_count = 0.0;  ///< negative when the sense is reversed
  double speed_units_per_rad = 0.0;
  std::int32_t window_counts = 0;
  DeviceName name;
  std::uint32_t modes = 0;  ///< object 6502
};

/// Asks a node what it is and what it can do.
class CanopenFactsScript final : public CanopenScript {
 public:
  /// Both outlive this.
  CanopenFactsScript(const CanopenConfig& config, const CanopenAxisConfig& axis,
                     CanopenCounters& counters) noexcept
      : config_(config), axis_(axis), counters_(counters) {}

  void begin(Stamp now) noexcept override;
  [[nodiscard]] std::optional<SdoRequest> next() const noexcept override;
  [[nodiscard]] CanopenProblem on_result(const SdoResult& result, const SdoClient& client,
                                         Stamp now) noexcept override;

  /// Valid when the script is done.
  [[nodiscard]] const CanopenFacts& facts() const noexcept { return facts_; }

 private:
  static constexpr std::size_t kReads = 14;

  [[nodiscard]] CanopenProblem conclude() noexcept;
  [[nodiscard]] CanopenProblem find_range() noexcept;
  [[nodiscard]] double scale() const noexcept;
  [[nodiscard]] std::optional<std::uint32_t> told(SdoAddress address) const noexcept;

  const CanopenConfig& config_;
  const CanopenAxisConfig& axis_;
  CanopenCounters& counters_;
  std::size_t at_ = 0;
  std::array<std::optional<std::uint32_t>, kReads> values_{};
  CanopenFacts facts_;
};

}  // namespace slamsensor::hal
